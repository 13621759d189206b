// Runs a peer on every state of a file, checks its torques, and lets callgrind count
// the calls of peer_step.
//
//     peer arm.txt states.txt

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <vector>

#include "peer.h"

static std::vector<double> numbers(std::istream& text) {
    std::vector<double> values;
    for (double value; text >> value;) values.push_back(value);
    return values;
}

int main(int, char** arguments) {
    std::ifstream arm(arguments[1]), states(arguments[2]);
    peer_setup(numbers(arm));
    double worst = 0.0;
    int count = 0;
    for (std::string line; std::getline(states, line);) {
        std::istringstream text(line);
        const auto row = numbers(text);
        const double* expected = row.data() + row.size() - 7;
        // Twice: the first call may bind symbols.
        for (int call = 0; call < 2; ++call) {
            double out[28];
            peer_step(row.data(), out);
            for (int i = 0; i < 7; ++i)
                worst = std::fmax(worst, std::fabs(out[i] - expected[i]));
        }
        ++count;
    }
    std::printf("%d states, largest difference of a torque %.1e Nm\n", count, worst);
    // Explicit inverses of the golden formulas: a condition number of 1e3.
    return count > 0 && worst < 1e-7 ? 0 : 1;
}
