/* Every case, one row each, in the order in which tables show them.
 * Beside the rows: list.c (this list as data) and planar.c (theory shared by the flat cases). */
#define PM_CASE_LIST(X) \
    X(square)           \
    X(gradient)         \
    X(quadratic)        \
    X(blob)             \
    X(sinusoid)         \
    X(edge)             \
    X(point_light)      \
    X(rect_light)       \
    X(corner)           \
    X(wall)             \
    X(sphere)           \
    X(volume)
