/* What an image shows: `render` says so in its header; of other files the name has to do. */
#include "report.h"

#include "../../cases/case.h"
#include "../../estimators/estimator.h"
#include "../methods/progressive/progressive.h"
#include "../methods/render.h"
#include "../transport/storing.h"

#include <string.h>

enum { SCENE_PREFIX = sizeof "scene:" - 1 };

/* The first words of the attribute `content`, and the end of the file's name. */
static const struct {
    const char *kind, *content, *suffix;
} kinds[] = {
    {"truth", "true radiance", ".truth"},         {"error", "(radiance - truth)", ".error"},
    {"bias", "(mean of trials", ".bias"},         {"noise", "standard deviation of trials", ".noise"},
    {"radius", "radius of the estimate", ".radius"}, {"count", "photons in the estimate", ".count"},
    {"image", "radiance, ", ""},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static const char *attribute(const pm__report_image *image, const char *name)
{
    return json_string_value(json_object_get(image->attributes, name));
}

static bool ends_in(const char *text, const char *end)
{
    const size_t length = strlen(text), wanted = strlen(end);
    return length > wanted && strcmp(text + length - wanted, end) == 0;
}

static const char *kind_of(const pm__report_image *image, const char *stem)
{
    const char *const content = attribute(image, "content");
    for (int i = 0; content && i < KINDS; i++)
        if (strncmp(content, kinds[i].content, strlen(kinds[i].content)) == 0)
            return kinds[i].kind;
    for (int i = 0; !content && i + 1 < KINDS; i++)
        if (ends_in(stem, kinds[i].suffix))
            return kinds[i].kind;
    return content || image->channels != 3 ? "other" : "image";
}

static void shorten(const pm__catalogue *catalogue, const char *text, char shorter[PM__NAME_SIZE])
{
    pm__spec spec;
    char name[PM__MAX_SPEC];
    (void)snprintf(name, sizeof name, "%s", text);
    if (pm__spec_parse(catalogue, text, &spec, NULL) == PM_OK)
        pm__spec_format_short(&spec, name, sizeof name);
    pm__quote_path(name, shorter);
}

void pm__report_shorten(const char *field, const char *text, char shorter[PM__NAME_SIZE])
{
    static const struct {
        const char *field;
        const pm__catalogue *catalogue;
    } known[] = {{"case", &pm__all_cases},       {"scene", &pm__all_cases},    {"estimator", &pm__estimators},
                 {"method", &pm__progressives}, {"policy", &pm__policies}};
    pm__quote_path(text, shorter);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(field, known[i].field) == 0)
            shorten(known[i].catalogue, text, shorter);
}

/* "disc, k = 50", "full: disc, k = 100", "path": by what the pixels were found. */
static void label_maker(const pm__report_image *image, const char *stem, char label[PM__NAME_SIZE])
{
    const char *const estimator = attribute(image, "estimator"), *const method = attribute(image, "method");
    const char *const k = attribute(image, "k"), *const radius = attribute(image, "radius");
    char name[PM__NAME_SIZE] = "", way[PM__NAME_SIZE] = "", text[3 * PM__NAME_SIZE];
    if (estimator)
        shorten(&pm__estimators, estimator, name);
    if (method)
        shorten(&pm__methods, method, way);
    const bool plain = estimator && strcmp(way, "visualize") == 0;
    if (!*name && !*way)
        (void)snprintf(text, sizeof text, "%s", stem);
    else
        (void)snprintf(text, sizeof text, "%s%s%s%s%.24s%s%.24s", plain ? "" : way, *name && *way && !plain ? ": " : "",
                       name, estimator && k ? ", k = " : "", estimator && k ? k : "",
                       estimator && radius ? ", R = " : "", estimator && radius ? radius : "");
    pm__quote_path(text, label);
}

static void join(char to[PM__NAME_SIZE], const char *a, const char *between, const char *b)
{
    char text[3 * PM__NAME_SIZE];
    (void)snprintf(text, sizeof text, "%s%s%s", a, between, b);
    pm__quote_path(text, to);
}

static void label_image(pm__report_image *image, const char *maker)
{
    const char *const truth = attribute(image, "truth"), *const content = attribute(image, "content");
    char known[PM__NAME_SIZE];
    if (strcmp(image->kind, "image") == 0)
        join(image->label, maker, "", "");
    else if (strcmp(image->kind, "truth") == 0 && truth) {
        (void)snprintf(known, sizeof known, "truth (%.40s)", truth);
        join(image->label, known, "", "");
    } else
        join(image->label, maker, ": ", strcmp(image->kind, "other") == 0 && content ? content : image->kind);
}

void pm__report_describe(pm__report_image *image, const char *stem)
{
    const char *const scene = attribute(image, "scene"), *const estimator = attribute(image, "estimator");
    const char *const method = attribute(image, "method");
    char maker[PM__NAME_SIZE], by[PM__NAME_SIZE] = "";
    image->kind = kind_of(image, stem);
    join(image->scene, "other images", "", "");
    if (scene)
        shorten(&pm__all_cases, scene, image->scene);
    label_maker(image, stem, maker);
    label_image(image, maker);
    if (estimator)
        shorten(&pm__estimators, estimator, by);
    else if (method)
        shorten(&pm__methods, method, by);
    if (!scene || !*by) {
        join(image->name, stem, "", "");
        return;
    }
    const bool prefixed = strncmp(image->scene, "scene:", SCENE_PREFIX) == 0;
    join(image->name, image->scene + (prefixed ? SCENE_PREFIX : 0), ".", by);
    if (strcmp(image->kind, "image") != 0)
        join(image->name, image->name, ".", image->kind);
}
