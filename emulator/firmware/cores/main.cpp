// Runs a core until its program ends. Exit code 1: it has not ended within the clocks of the second argument.
#include <cstdio>
#include <cstdlib>

#include "Vtop.h"
#include "verilated.h"

int main(int count, char **arguments) {
    VerilatedContext context;
    context.commandArgs(count, arguments);
    Vtop top{&context};
    const unsigned long limit = std::strtoul(arguments[count - 1], nullptr, 10);
    for (unsigned long clock = 0; clock < limit && !context.gotFinish(); ++clock) {
        top.reset = clock < 8;
        top.clk = 0;
        top.eval();
        top.clk = 1;
        top.eval();
    }
    if (context.gotFinish()) return 0;
    std::fprintf(stderr, "the program has not ended after %lu clocks\n", limit);
    return 1;
}
