#include "tools/command/command_line.hpp"

int main(int argc, char** argv) { return odoless::run_command_line(argc, argv); }
