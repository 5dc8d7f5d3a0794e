/* What a whole report would have besides. */
#include "report.h"

#include <string.h>

static const struct {
    const char *part, *how;
} parts[] = {
    {"accuracy", "photonbench accuracy --profile full --json accuracy.json"},
    {"search", "photonbench search --case box,square,caustic,volume --k 8,50,500 --search all --json search.json"},
    {"storage", "photonbench storage --profile full --json storage.json"},
    {"converge", "photonbench converge plate water glass-sphere --method all --profile full --json converge.json"},
    {"stress", "photonbench stress --profile full --json stress.json"},
    {"images", "photonbench render cornell glass-sphere --estimator all --aov -o images.exr"},
};

/* Rows of a command; *given: a file of it was. */
static size_t count_rows(const pm__report *report, const char *command, bool *given)
{
    size_t count = 0;
    *given = false;
    for (size_t i = 0; i < report->result_count; i++)
        if (strcmp(report->results[i].command, command) == 0) {
            *given = true;
            count += json_array_size(report->results[i].rows);
        }
    return count;
}

json_t *pm__report_missing(const pm__report *report)
{
    json_t *const missing = json_array();
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        bool given;
        char what[120];
        const bool images = strcmp(parts[i].part, "images") == 0;
        if (images ? report->image_count > 0 : count_rows(report, parts[i].part, &given) > 0)
            continue;
        if (images)
            (void)snprintf(what, sizeof what, "no image was given");
        else
            (void)snprintf(what, sizeof what, given ? "the result file of `%s` has no rows"
                                                    : "no result file of `%s` was given", parts[i].part);
        (void)json_array_append_new(missing, json_pack("{s:s, s:s, s:s}", "part", parts[i].part, "what", what, "how",
                                                       parts[i].how));
    }
    return missing;
}
