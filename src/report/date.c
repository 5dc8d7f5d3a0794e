/* When the report was made. */
#include "report.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST_DIGITS = 12 }; /* of seconds: the year has four digits, or five */

pm_status pm__report_set_date(pm__report *report, const char *epoch, pm_error *error)
{
    time_t seconds = time(NULL);
    struct tm parts;
    if (epoch) {
        const size_t digits = strspn(epoch, "0123456789");
        if (!digits || epoch[digits] || digits > MOST_DIGITS)
            return pm__fail(error, PM_EINVAL, "SOURCE_DATE_EPOCH: '%.40s' is not a number of seconds", epoch);
        seconds = (time_t)strtoll(epoch, NULL, 10);
    }
    if (!gmtime_r(&seconds, &parts) || !strftime(report->date, sizeof report->date, "%Y-%m-%dT%H:%M:%SZ", &parts))
        return pm__fail(error, PM_EINVAL, "SOURCE_DATE_EPOCH: no date is %lld s", (long long)seconds);
    return PM_OK;
}
