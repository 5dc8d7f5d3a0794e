/* Every stored reference, one row each: for X(NAME) the files cases/scenes/references/NAME.exr and NAME.error.exr become
 * part of the program, as the reference of the scene of that name (with - for _). */
#define PM__REFERENCE_LIST(X)
