// C code of CasADi behind the interface of a peer; GENERATED is its file.

#include "peer.h"

extern "C" {
#include GENERATED
}

void peer_setup(const std::vector<double>&) {}

void peer_step(const double* in, double* out) {
    const double* arguments[] = {in};
    double* results[] = {out};
    static casadi_int integers[64];
    static double work[65536];
    generated(arguments, results, integers, work, 0);
}
