#include "curvature.h"

#include "../../base/gauss.h"

pm__blur pm__blur_of(const pm_estimator *estimator)
{
    enum { NODES = 32 };
    double s[NODES], ds[NODES], c = 0.0, square = 0.0, moment = 0.0;
    pm__gauss_legendre(NODES, s, ds);
    for (int i = 0; i < NODES; i++) {
        const double w = pm__estimator_of(&estimator->spec)->weight(estimator->spec.values, s[i]);
        c += ds[i] * w;
        square += ds[i] * w * w;
        moment += ds[i] * w * s[i];
    }
    return (pm__blur){square / (c * c), moment / c};
}
