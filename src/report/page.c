/* The page: a template that is part of the program, and the data in place of one of its lines. */
#include "report.h"

#include "../image/embed.h"

#include <stdint.h>
#include <string.h>

PM__EMBED(pm__page_template, "reports/page/dist/page.html");
PM__EMBED(pm__page_errata, "reports/errata.json");

#define MARK "<!--PM-DATA-->"

enum { IMAGE_OVERHEAD = 2048, GROUP = 3 * 1024 /* bytes: a whole number of threes */ };

/* Not a difference of pointers: to the language the two are of different arrays. */
static size_t bytes_between(const unsigned char *start, const unsigned char *end)
{
    return (size_t)((uintptr_t)end - (uintptr_t)start);
}

/* ---- What stands in the page -------------------------------------------------------------------- */

static size_t size_in_page(const pm__report_image *image)
{
    return (image->exr_size + 2) / 3 * 4 + IMAGE_OVERHEAD;
}

static size_t size_of_scene(const pm__report *report, const char *scene)
{
    size_t size = 0;
    for (size_t i = 0; i < report->image_count; i++)
        if (strcmp(report->images[i].scene, scene) == 0)
            size += size_in_page(&report->images[i]);
    return size;
}

static size_t size_without_images(const pm__report *report)
{
    size_t size = bytes_between(pm__page_template, pm__page_template_end) +
                  bytes_between(pm__page_errata, pm__page_errata_end);
    for (size_t i = 0; i < report->result_count; i++)
        size += report->results[i].size;
    return size;
}

static bool is_first_of_scene(const pm__report *report, size_t index)
{
    for (size_t i = 0; i < index; i++)
        if (strcmp(report->images[i].scene, report->images[index].scene) == 0)
            return false;
    return true;
}

/* Scenes are whole, within the page or beside it; of the first as many as fit, so that a page alone shows some. */
void pm__report_place(pm__report *report)
{
    size_t used = size_without_images(report);
    bool full = false;
    for (size_t i = 0; i < report->image_count; i++) {
        if (!is_first_of_scene(report, i))
            continue;
        full = full || (i > 0 && used + size_of_scene(report, report->images[i].scene) > PM__REPORT_PAGE_BYTES);
        for (size_t j = i; j < report->image_count; j++) {
            pm__report_image *const image = &report->images[j];
            if (strcmp(image->scene, report->images[i].scene) != 0)
                continue;
            full = full || used + size_in_page(image) > PM__REPORT_PAGE_BYTES;
            image->beside = full;
            used += full ? IMAGE_OVERHEAD : size_in_page(image);
        }
    }
}

/* ---- Writing ------------------------------------------------------------------------------------ */

static void write_base64(FILE *file, const unsigned char *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t at = 0; at < size; at += GROUP) {
        char text[GROUP / 3 * 4];
        const size_t count = size - at < GROUP ? size - at : GROUP;
        size_t used = 0;
        for (size_t i = at; i < at + count; i += 3) {
            const size_t left = at + count - i;
            const unsigned three = (unsigned)bytes[i] << 16 | (left > 1 ? (unsigned)bytes[i + 1] << 8 : 0U) |
                                   (left > 2 ? bytes[i + 2] : 0U);
            text[used++] = digits[three >> 18];
            text[used++] = digits[three >> 12 & 63];
            text[used++] = left > 1 ? digits[three >> 6 & 63] : '=';
            text[used++] = left > 2 ? digits[three & 63] : '=';
        }
        (void)fwrite(text, 1, used, file);
    }
}

static int write_piece(const char *text, size_t size, void *file)
{
    pm__report_write_escaped(file, text, size);
    return 0;
}

/* Takes `value` over; where memory was refused for it Jansson's owner knows. */
static void write_value(FILE *file, json_t *value)
{
    (void)json_dump_callback(value, write_piece, file, JSON_COMPACT | JSON_ENCODE_ANY);
    json_decref(value);
}

static void write_member(FILE *file, const char *name, json_t *value)
{
    (void)fprintf(file, "\"%s\":", name);
    write_value(file, value);
}

static json_t *text(const char *from)
{
    return pm__report_text(from, strlen(from));
}

/* The first result file that says so: of the tree that the program was built from. */
static json_t *commit_of(const pm__report *report)
{
    for (size_t i = 0; i < report->result_count; i++) {
        const json_t *const root = report->results[i].root;
        json_t *const own = json_object_get(root, "commit");
        json_t *const machines = json_object_get(json_object_get(root, "machine"), "commit");
        if (json_is_string(own) || json_is_string(machines))
            return json_incref(json_is_string(own) ? own : machines);
    }
    return json_null();
}

static void write_results(const pm__report *report, FILE *file)
{
    (void)fputs(",\n\"files\":[", file);
    for (size_t i = 0; i < report->result_count; i++) {
        const pm__report_result *const result = &report->results[i];
        (void)fputs(i ? ",\n{" : "\n{", file);
        write_member(file, "name", text(result->name));
        (void)fputc(',', file);
        write_member(file, "left_out", json_integer((json_int_t)result->left_out));
        (void)fputs(",\"result\":", file);
        pm__report_write_escaped(file, result->text, result->size);
        (void)fputc('}', file);
    }
    (void)fputc(']', file);
}

static json_t *describe_image(const pm__report_image *image)
{
    json_t *const channels = image->channels == 3 ? json_pack("[s, s, s]", "R", "G", "B") : json_pack("[s]", "Y");
    json_t *const href = image->beside ? json_sprintf("images/%s.js", image->file) : json_null();
    return json_pack("{s:o, s:o, s:o, s:o, s:s, s:I, s:I, s:o, s:o, s:O}", "name", text(image->name), "file",
                     text(image->file), "scene", text(image->scene), "label", text(image->label), "kind", image->kind,
                     "width", (json_int_t)image->width, "height", (json_int_t)image->height, "channels", channels,
                     "href", href, "attributes", image->attributes);
}

static void write_images(const pm__report *report, FILE *file)
{
    (void)fputs(",\n\"images\":[", file);
    for (size_t i = 0; i < report->image_count; i++) {
        const pm__report_image *const image = &report->images[i];
        json_t *const described = describe_image(image), *value;
        const char *key;
        (void)fputs(i ? ",\n{" : "\n{", file);
        json_object_foreach(described, key, value) {
            write_member(file, key, json_incref(value));
            (void)fputc(',', file);
        }
        json_decref(described);
        (void)fputs(image->beside ? "\"exr\":null" : "\"exr\":\"", file);
        if (!image->beside)
            write_base64(file, image->exr, image->exr_size);
        (void)fputs(image->beside ? "}" : "\"}", file);
    }
    (void)fputc(']', file);
}

static void write_data(const pm__report *report, FILE *file)
{
    (void)fputs("<script type=\"application/json\" id=\"pm-report\">{", file);
    write_member(file, "schema", json_string("photonbench-report/1"));
    (void)fputc(',', file);
    write_member(file, "version", json_string(report->version));
    (void)fputc(',', file);
    write_member(file, "commit", commit_of(report));
    (void)fputc(',', file);
    write_member(file, "date", json_string(report->date));
    write_results(report, file);
    write_images(report, file);
    (void)fputs(",\n\"errata\":", file);
    pm__report_write_escaped(file, (const char *)pm__page_errata, bytes_between(pm__page_errata, pm__page_errata_end));
    (void)fputs(",\n", file);
    write_member(file, "missing", pm__report_missing(report));
    (void)fputs("}</script>", file);
}

/* From `at` on, the line that is the mark and nothing else; NULL: there is none. */
static const char *find_mark(const char *template, const char *at, const char *end)
{
    for (; (at = memmem(at, (size_t)(end - at), MARK, sizeof MARK - 1)) != NULL; at++) {
        const char *const after = at + sizeof MARK - 1;
        if ((at == template || at[-1] == '\n') && (after == end || *after == '\n'))
            return at;
    }
    return NULL;
}

pm_status pm__report_write_template(const pm__report *report, const char *template, size_t size, FILE *file,
                                    pm_error *error)
{
    const char *const end = template + size, *const mark = find_mark(template, template, end);
    if (!mark || find_mark(template, mark + 1, end))
        return pm__fail(error, PM_EBROKEN, "the page's template has %s line " MARK, mark ? "more than one" : "no");
    (void)fwrite(template, 1, (size_t)(mark - template), file);
    write_data(report, file);
    (void)fwrite(mark + sizeof MARK - 1, 1, (size_t)(end - mark) - (sizeof MARK - 1), file);
    return PM_OK;
}

pm_status pm__report_write_page(const pm__report *report, FILE *file, pm_error *error)
{
    return pm__report_write_template(report, (const char *)pm__page_template,
                                     bytes_between(pm__page_template, pm__page_template_end), file, error);
}

void pm__report_write_script(const pm__report_image *image, FILE *file)
{
    (void)fprintf(file, "window.pmImage(\"%s\", \"", image->file);
    write_base64(file, image->exr, image->exr_size);
    (void)fputs("\");\n", file);
}
