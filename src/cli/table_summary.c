/* The answer in short: which estimator to take for each case. */
#include "table.h"

#include <string.h>

static bool eligible(const pm__accuracy_row *row)
{
    const pm__estimator *const estimator = (const pm__estimator *)(const void *)row->estimator_spec->entry;
    return strcmp(row->region, "all") == 0 && !(estimator->needs & PM__TRUTH) && isfinite(row->rel_rmse);
}

static const pm__accuracy_row *least_error(const pm__table *table, size_t first, size_t end)
{
    const pm__accuracy_row *best = NULL;
    for (size_t i = first; i < end; i++)
        if (eligible(&table->rows[i]) && (!best || table->rows[i].rel_rmse < best->rel_rmse))
            best = &table->rows[i];
    return best;
}

static const pm__accuracy_row *cheapest(const pm__table *table, size_t first, size_t end, double rmse)
{
    const pm__accuracy_row *best = NULL;
    for (size_t i = first; i < end; i++) {
        const pm__accuracy_row *const row = &table->rows[i];
        if (eligible(row) && row->rel_rmse <= rmse && isfinite(row->cost_s) && (!best || row->cost_s < best->cost_s))
            best = row;
    }
    return best;
}

static void print_choice(const pm__table *table, const char *left, const char *what, const pm__accuracy_row *row)
{
    char estimator[PM__MAX_SPEC], lookup[48], text[PM__MAX_SPEC + 64];
    pm__spec_format_short(row->estimator_spec, estimator, sizeof estimator);
    pm__table_lookup(row, lookup, sizeof lookup);
    (void)snprintf(text, sizeof text, "%s, %s", estimator, lookup);
    (void)fprintf(table->file, "%-24s %-11s %-36s", left, what, text);
    pm__table_number(table->file, 6, 100.0 * row->rel_rmse, 0);
    (void)fputs(" %", table->file);
    pm__table_number(table->file, 8, 1000.0 * row->cost_s, 0);
    (void)fputs(" ms\n", table->file);
}

static void print_run(const pm__table *table, size_t first, size_t end)
{
    const pm__accuracy_row *const best = least_error(table, first, end);
    if (!best)
        return;
    char name[PM__MAX_SPEC], sampler[PM__MAX_SPEC], label[2 * PM__MAX_SPEC + 40];
    pm__spec_format_short(best->case_spec, name, sizeof name);
    pm__spec_format_short(best->sampler_spec, sampler, sizeof sampler);
    (void)snprintf(label, sizeof label, "%s", name);
    if (table->config->sampler_count > 1 || table->config->photon_count > 1)
        (void)snprintf(label, sizeof label, "%s %s %zu", name, sampler, best->photons);
    if (strlen(label) > 24) {
        (void)fprintf(table->file, "%s\n", label);
        *label = '\0';
    }
    const pm__accuracy_row *const cheap = cheapest(table, first, end, 1.1 * best->rel_rmse);
    const bool same = cheap == best;
    print_choice(table, label, same ? "both" : "least error", best);
    if (cheap && !same)
        print_choice(table, "", "cheapest", cheap);
}

void pm__table_summary(const pm__table *table)
{
    (void)fputs("\nLeast rmse in region all, and the cheapest within 10 % of it, of those that do without the truth\n"
                "(cost: the photons drawn, the map built and the queries of region all, on one thread)\n",
                table->file);
    for (size_t i = 0; i < table->row_count;) {
        const size_t end = pm__table_run(table, i, false);
        print_run(table, i, end);
        i = end;
    }
}
