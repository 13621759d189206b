// What the driver asks of a peer.
#pragma once

#include <vector>

/// Numbers of arm.txt.
void peer_setup(const std::vector<double>& arm);

/// One cycle. Input as `layout` in prepare.py orders it; output torque, residual,
/// momentum and observer input, seven each.
extern "C" __attribute__((noinline)) void peer_step(const double* in, double* out);
