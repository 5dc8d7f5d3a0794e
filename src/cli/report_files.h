/* The files of `report`. */
#ifndef PM_CLI_REPORT_FILES_H
#define PM_CLI_REPORT_FILES_H

#include "../report/report.h"

/* The page and what stands beside it, into a folder that is made, with those above it, where there is none. Each file
 * is complete or absent, and the page is the last. EIO, ENOMEM, EBROKEN. */
pm_status pm__report_files_write(const pm__report *report, const char *folder, pm_error *error);

/* Tables and scripts of the figures that there are rows for, and, where gnuplot is installed, what it draws; where not,
 * and not `quiet`, a message says so. EIO, ENOMEM. */
pm_status pm__report_figures_write(const pm__report *report, const char *folder, bool quiet, pm_error *error);

/* Makes a folder and those above it. EIO, ENOMEM. */
pm_status pm__make_folder(const char *path, pm_error *error);

/* "FOLDER/NAME", with the parts of a name joined; the caller's, NULL where memory is refused. */
char *pm__path_in(const char *folder, const char *name, const char *ending);

#endif
