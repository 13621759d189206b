// The header in C++, twice, and a call through it.
#include "stratum.h"
#include "stratum.h"

int main() {
    static StratumSettings settings;
    return stratum_settings_default(STRATUM_ABI_VERSION, &settings);
}
