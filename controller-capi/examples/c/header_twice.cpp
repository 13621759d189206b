// The header in C++, twice, and a call through it.
#include "stratum.h"
#include "stratum.h"

int main() {
    static StratumSettings settings;
    StratumResult result = stratum_settings_default(STRATUM_ABI_VERSION, &settings);
    // Numbers, not enumerations: sums of axes and codes from elsewhere stay possible.
    settings.levels[0].axes = STRATUM_AXIS_X | STRATUM_AXIS_Y;
    settings.damping = STRATUM_DAMPING_INERTIA;
    const StratumReference hold = {};
    int code = result;
    return code == STRATUM_OK && hold.kind == STRATUM_TARGET_HOLD ? 0 : 1;
}
