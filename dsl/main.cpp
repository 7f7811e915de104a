// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/program.hpp>

int main(int argc, char** argv) { return trellis::run_program(argc, argv); }
