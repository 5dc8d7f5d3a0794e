/* Functions that must vanish into the loop that calls them, or it does not become SIMD. */
#ifndef PM_BASE_INLINE_H
#define PM_BASE_INLINE_H

#define PM__INLINE static inline __attribute__((always_inline))

#endif
