/* Every stored reference, one row each, on lines of their own: for X(NAME) the files NAME.exr and NAME.error.exr of
 * cases/scenes/references become part of the program, as the reference of the scene of that name (with - for _).
 * cases/scenes/references/make.sh makes them. */
#define PM__REFERENCE_LIST(X) \
    X(cornell)                \
    X(cornell_diffuse)        \
    X(cornell_water)          \
    X(four_lights)            \
    X(fractal_cornell)        \
    X(cognac)                 \
    X(torus)                  \
    X(lamp)                   \
    X(egg)                    \
    X(office)                 \
    X(maze)                   \
    X(wide_floor)
