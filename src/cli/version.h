/* The one place that says which version this is. */
#ifndef PM_CLI_VERSION_H
#define PM_CLI_VERSION_H

#define PM_VERSION "0.1.0"

#endif
