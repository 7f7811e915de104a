// SPDX-License-Identifier: GPL-3.0-or-later
// named_planner NAME ARGUMENTS...: the command `trellis` with a planner of that name, which draws proposals and finds
// no path.
#include <iostream>
#include <string>
#include <utility>

#include <trellis/planner/own_planner.hpp>
#include <trellis/program.hpp>

namespace {

using namespace trellis;

std::string& name() {
  static std::string given;
  return given;
}

const Settings<CommonSettings>& settings() {
  static const auto all =
      with_common(Settings<CommonSettings>(Component::Kind::planner, name(), "draws and finds no path", ""));
  return all;
}

class Drawing final : public Planner {
 public:
  Drawing(const CommonSettings& /*settings*/, PlannerContext context) : context_(std::move(context)) {}

  Solution solve(const Budget& budget) override {
    BudgetMonitor monitor(context_, budget);
    const std::uint32_t root = add_node(context_, context_.instance.start);
    Configuration proposal(context_.instance.space.dimension());
    for (;;) {
      if (const auto reason = monitor.spent()) return {*reason, branch_to(context_.search, root)};
      propose(context_, proposal);
      record_outcome(context_, {.proposal = proposal});
    }
  }

 private:
  PlannerContext context_;
};

}  // namespace

int main(int argc, char** argv) {
  name() = argc > 1 ? argv[1] : "";
  try {
    register_planner<settings, Drawing>();
  } catch (const Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
  return run_program(argc - 1, argv + 1);
}
