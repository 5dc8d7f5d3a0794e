/* Every peer, one row each, under the library that it needs; the build defines PM_PEER_... for those that are there.
 * Beside the rows: list.c (this list as data) and collect.h (result sets that select, shared). */
#ifdef PM_PEER_NANOFLANN
#define PM_PEER_NANOFLANN_LIST(X) X(nanoflann) X(nanoflann_select)
#else
#define PM_PEER_NANOFLANN_LIST(X)
#endif
#ifdef PM_PEER_FLANN
#define PM_PEER_FLANN_LIST(X) X(flann) X(flann_select)
#else
#define PM_PEER_FLANN_LIST(X)
#endif
#ifdef PM_PEER_ANN
#define PM_PEER_ANN_LIST(X) X(ann)
#else
#define PM_PEER_ANN_LIST(X)
#endif
#ifdef PM_PEER_CGAL
#define PM_PEER_CGAL_LIST(X) X(cgal) X(cgal_select)
#else
#define PM_PEER_CGAL_LIST(X)
#endif
#ifdef PM_PEER_EMBREE
#define PM_PEER_EMBREE_LIST(X) X(embree_pointquery) X(embree_pointquery_select)
#else
#define PM_PEER_EMBREE_LIST(X)
#endif

#define PM_PEER_LIST(X)       \
    PM_PEER_NANOFLANN_LIST(X) \
    PM_PEER_FLANN_LIST(X)     \
    PM_PEER_ANN_LIST(X)       \
    PM_PEER_CGAL_LIST(X)      \
    PM_PEER_EMBREE_LIST(X)
