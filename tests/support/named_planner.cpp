// SPDX-License-Identifier: GPL-3.0-or-later
// named_planner NAME ARGUMENTS...: the command `trellis` with a planner of that name, which draws proposals and finds
// no path.
#include <iostream>
#include <optional>
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
  Drawing(const CommonSettings& /*settings*/, PlannerContext context)
      : Planner(std::move(context)), proposal_(context_.instance.space.dimension()) {}

  std::optional<Status> begin(const Budget& /*budget*/) override {
    root_ = add_node(context_, context_.instance.start);
    return std::nullopt;
  }
  std::optional<Status> step() override {
    propose(context_, proposal_);
    record_outcome(context_, {.proposal = proposal_});
    return std::nullopt;
  }
  Solution solution(Status status) override { return {status, branch_to(context_.search, root_)}; }

 private:
  Configuration proposal_;
  std::uint32_t root_ = no_node;
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
