#include "tools/odolessd/command_line.hpp"

int main(int argc, char** argv) { return odoless::run_odolessd(argc, argv); }
