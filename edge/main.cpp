// Program bess-edge: a command (edge/app/commands/), or the controller itself (run_command.cpp).
#include "edge/app/commands/command.h"

int main(int argc, char** argv) { return bess::run_command_line(argc, argv); }
