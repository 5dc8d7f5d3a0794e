/* The page, the images beside it, and their folders. */
#include "report_files.h"
#include "refused.h"
#include "results.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static pm_status make_one(const char *path, pm_error *error)
{
    struct stat status;
    char name[PM__NAME_SIZE];
    if (mkdir(path, 0777) == 0 || (errno == EEXIST && stat(path, &status) == 0 && S_ISDIR(status.st_mode)))
        return PM_OK;
    const int number = errno == EEXIST ? ENOTDIR : errno;
    pm__quote_path(path, name);
    return pm__fail(error, PM_EIO, "%s: the folder cannot be made: %s", name, strerror(number));
}

pm_status pm__make_folder(const char *path, pm_error *error)
{
    char *const part = strdup(path);
    pm_status status = part ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory");
    for (char *slash = part; status == PM_OK && *slash && (slash = strchr(slash + 1, '/')) != NULL;) {
        *slash = '\0';
        status = make_one(part, error);
        *slash = '/';
    }
    if (status == PM_OK)
        status = make_one(path, error);
    free(part);
    return status;
}

char *pm__path_in(const char *folder, const char *name, const char *ending)
{
    char *path = NULL;
    return asprintf(&path, "%s/%s%s", folder, name, ending) < 0 ? NULL : path;
}

/* What `write` makes of the report, or of one of its images, in a file that is complete or absent. */
typedef pm_status writer(const pm__report *report, const pm__report_image *image, FILE *file, pm_error *error);

static pm_status write_file(const char *folder, const char *name, const char *ending, writer *write,
                            const pm__report *report, const pm__report_image *image, pm_error *error)
{
    pm__sink sink = {.wanted = false};
    char *const path = pm__path_in(folder, name, ending);
    pm_status status = path ? pm__sink_open(path, &sink, error) : pm__fail(error, PM_ENOMEM, "out of memory");
    free(path);
    if (status != PM_OK)
        return status;
    status = write(report, image, pm__sink_file(&sink), error);
    if (status == PM_OK)
        status = pm__refused_status(error);
    if (status == PM_OK)
        return pm__sink_close(&sink, error);
    pm__sink_discard(&sink);
    return status;
}

static pm_status write_page(const pm__report *report, const pm__report_image *image, FILE *file, pm_error *error)
{
    (void)image;
    return pm__report_write_page(report, file, error);
}

static pm_status write_script(const pm__report *report, const pm__report_image *image, FILE *file, pm_error *error)
{
    (void)report;
    (void)error;
    pm__report_write_script(image, file);
    return PM_OK;
}

static pm_status write_exr(const pm__report *report, const pm__report_image *image, FILE *file, pm_error *error)
{
    (void)report;
    (void)error;
    (void)fwrite(image->exr, 1, image->exr_size, file);
    return PM_OK;
}

/* The name of an image ends in .exr where its file's did. */
static pm_status write_beside(const pm__report *report, const pm__report_image *image, const char *folder,
                              pm_error *error)
{
    const size_t length = strlen(image->file);
    const bool ended = length > 4 && strcmp(image->file + length - 4, ".exr") == 0;
    const pm_status status = write_file(folder, image->file, ended ? "" : ".exr", write_exr, report, image, error);
    return status == PM_OK ? write_file(folder, image->file, ".js", write_script, report, image, error) : status;
}

static bool has_images_beside(const pm__report *report)
{
    for (size_t i = 0; i < report->image_count; i++)
        if (report->images[i].beside)
            return true;
    return false;
}

pm_status pm__report_files_write(const pm__report *report, const char *folder, pm_error *error)
{
    const bool beside = has_images_beside(report);
    char *const images = pm__path_in(folder, "images", "");
    pm_status status = images ? pm__make_folder(folder, error) : pm__fail(error, PM_ENOMEM, "out of memory");
    if (status == PM_OK && beside)
        status = pm__make_folder(images, error);
    for (size_t i = 0; status == PM_OK && i < report->image_count; i++)
        if (report->images[i].beside)
            status = write_beside(report, &report->images[i], images, error);
    if (status == PM_OK)
        status = write_file(folder, "index.html", "", write_page, report, NULL, error);
    free(images);
    return status;
}
