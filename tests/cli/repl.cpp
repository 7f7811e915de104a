// SPDX-License-Identifier: GPL-3.0-or-later
// `trellis repl`: interactive sessions at a terminal, and piped lines.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/golden.hpp"
#include "support/process.hpp"
#include "support/terminal.hpp"

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using trellis::test::content;
using trellis::test::Place;
using trellis::test::Terminal;

namespace {

constexpr const char* ctrl_c = "\x03";
constexpr const char* ctrl_d = "\x04";

/// A session at a terminal, with a history of its own.
class Sitting {
 public:
  explicit Sitting(const Place& place, std::vector<std::string> arguments = {}, const std::string& editor = "true",
                   const std::string& keys = "set enable-bracketed-paste off\n")
      : terminal(place / "", with_verb(std::move(arguments)),
                 {{"TRELLIS_HISTORY", place / "history"},
                  {"INPUTRC", place.script("inputrc", keys)},
                  {"VISUAL", editor},
                  {"NO_COLOR", "1"}}) {
    greeting = terminal.wait_for(Terminal::prompt);
  }

  std::string enter(const std::string& line) { return terminal.enter(line); }

  Terminal terminal;
  std::string greeting;

 private:
  static std::vector<std::string> with_verb(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "repl");
    return arguments;
  }
};

/// Lines that are piped into the program.
struct Piped {
  std::string out;
  std::string err;
  int status = 0;
};
Piped pipe(const Place& place, const std::string& lines) {
  place.script("lines", lines);
  const std::string command = "cd '" + place / "" + "' && '" TRELLIS_BINARY "' repl <lines >out 2>err";
  const int status = std::system(command.c_str());  // NOLINT(concurrency-mt-unsafe)
  return {content(place / "out"), content(place / "err"), WEXITSTATUS(status)};
}

}  // namespace

TEST_CASE("expressions print themselves") {
  const Place place;
  Sitting sitting(place);
  CHECK_THAT(sitting.greeting, Contains("help()"));
  CHECK_THAT(sitting.enter("1 + 2"), Contains("\n3\r\n"));
  CHECK_THAT(sitting.enter("x = 21"), !Contains("\n21"));
  CHECK_THAT(sitting.enter("2 * x, 'text'"), Contains("\n42\r\ntext\r\n"));
  CHECK_THAT(sitting.enter("{ 1, { a = 'b' } }"), Contains("\n{ 1, { a = \"b\" } }\r\n"));
  CHECK_THAT(sitting.enter("skeleton() >> shrink(0.5) >> rrt { step = 0.4 }"),
             Contains("rrt { step = 0.4 }\r\n└─ shrink(0.5)  searched by rrt { step = 0.4 }\r\n   └─ skeleton()"));
  CHECK_THAT(sitting.enter("scenes.cup()"), Contains("problem 'cup' in SE(2)"));
}

TEST_CASE("help describes words, values and the session's own functions") {
  const Place place;
  Sitting sitting(place);
  CHECK_THAT(sitting.enter("help(skeleton() >> rrt {})"),
             Contains("strategy: skeleton() >> rrt()") && Contains("└─ skeleton()"));
  CHECK_THAT(sitting.enter("help(shrink(0.5))"), Contains("shrink (guide)"));
  CHECK_THAT(sitting.enter("help(scenes.trap)"), Contains("scenes.trap: four false passages"));
  CHECK_THAT(sitting.enter("help(plan)"), Contains("plan(strategy"));
  CHECK_THAT(sitting.enter("help 'plan'"), Contains("plan(strategy"));
  CHECK_THAT(sitting.enter("help(7)"), Contains("nothing is known about 7"));
}

TEST_CASE("the last value and the inputs before are at hand") {
  const Place place;
  Sitting sitting(place);
  sitting.enter("1 + 2");
  CHECK_THAT(sitting.enter("2 * _"), Contains("\n6\r\n"));
  sitting.enter("skeleton() >> rrt { step = 0.5 }");
  sitting.enter("nested = _");
  CHECK_THAT(sitting.enter("history(2)"), Contains("   4  nested = _\r\n   5  history(2)\r\n"));
  CHECK_THAT(sitting.enter("history()"), Contains("   1  1 + 2\r\n   2  2 * _\r\n"));
  // What is saved gives the same values.
  sitting.enter("save 'kept.lua'");
  CHECK_THAT(content(place / "kept.lua"), Contains("-- nested = _\nnested = skeleton() >> rrt()\n"));
  // The names of all words fit a screen.
  const std::string names = sitting.enter("help()");
  CHECK_THAT(names, Contains("session: plan start") && Contains("planners: rrt ") && Contains("help \"shrink\""));
  CHECK(std::count(names.begin(), names.end(), '\n') < 40);
}

TEST_CASE("an input continues until it is complete") {
  const Place place;
  Sitting sitting(place);
  sitting.terminal.type("function twice(n)\n");
  sitting.terminal.wait_for("..> ");
  sitting.terminal.type("return 2 * n\n");
  sitting.terminal.wait_for("..> ");
  sitting.enter("end");
  CHECK_THAT(sitting.enter("twice(4)"), Contains("\n8\r\n"));
  sitting.terminal.type("skeleton() >>\n");
  sitting.terminal.wait_for("..> ");
  CHECK_THAT(sitting.enter("rrt {}"), Contains("└─ skeleton()"));
}

TEST_CASE("lines that are pasted are taken as if they were typed") {
  const Place place;
  Sitting sitting(place, {}, "true", "set enable-bracketed-paste on\n");
  const auto paste = [&](const std::string& text) {
    sitting.terminal.type("\x1b[200~" + text + "\x1b[201~\n");
    return sitting.terminal.wait_for(Terminal::prompt);
  };
  CHECK_THAT(paste("a = 20\nb = 22\na + b"), Contains("42\r\n"));
  CHECK_THAT(paste("function f(x)\n  return x + 1\nend\nf(6)"), Contains("7\r\n"));
  // A local is there for the lines below it.
  CHECK_THAT(paste("local c = 5\nprint(c * a)"), Contains("100\r\n"));
}

TEST_CASE("errors name the place and the nearest name, and end nothing") {
  const Place place;
  Sitting sitting(place);
  CHECK_THAT(sitting.enter("shrnk(0.5)"), Contains("unknown name 'shrnk' (did you mean 'shrink'?)"));
  CHECK_THAT(sitting.enter("x = = 1"), Contains("input 2:1: unexpected symbol near '='"));
  CHECK_THAT(sitting.enter("plan(skeleton())"), Contains("only guides; end it with >> rrt {}"));
  CHECK_THAT(sitting.enter("plan(rrt {}, { sed = 2 })"), Contains("did you mean 'seed'?"));
  CHECK_THAT(sitting.enter("plan(rrt {}, scenes.cup)"), Contains("got a function: call it"));
  CHECK_THAT(sitting.enter("levels()"), Contains("there is no run yet"));
  CHECK_THAT(sitting.enter("levels"), Contains("levels(): what each level of a run did"));
  CHECK_THAT(sitting.enter("1"), Contains("\n1\r\n"));
}

TEST_CASE("Tab completes names, fields, options and scenes") {
  const Place place;
  Sitting sitting(place);
  sitting.enter("strat_of_mine = 1");
  sitting.terminal.type("skel\t() >> rrt { st\t0.3 }");
  CHECK_THAT(sitting.enter(""), Contains("rrt { step = 0.3 }\r\n└─ skeleton()"));
  sitting.terminal.type("strat_\t");
  CHECK_THAT(sitting.enter(""), Contains("\n1\r\n"));
  sitting.terminal.type("scenes.sim\t()");
  CHECK_THAT(sitting.enter(""), Contains("problem 'simple_passage'"));
  sitting.terminal.type("help \"shr\t");
  CHECK_THAT(sitting.enter(""), Contains("shrink (guide)"));
}

TEST_CASE("habits of other shells do what they mean") {
  const Place place;
  {
    Sitting sitting(place);
    CHECK_THAT(sitting.enter("= 1 + 1"), Contains("\n2\r\n"));
    CHECK_THAT(sitting.enter("help shrink"), Contains("shrink (guide)"));
    CHECK_THAT(sitting.enter("shrink?"), Contains("shrink (guide)"));
    CHECK_THAT(sitting.enter("scenes.cup?"), Contains("scenes.cup"));
    CHECK_THAT(sitting.enter("scenes.cup??"), Contains("stdlib/scenes.lua:") && Contains("scenes.cup = scene("));
    CHECK_THAT(sitting.enter("shrink??"), Contains("the same world for a smaller robot"));
    CHECK_THAT(sitting.enter("plan??"), Contains("part of the runtime"));
    sitting.enter("function twice(x) return 2 * x end");
    CHECK_THAT(sitting.enter("twice??"), Contains("input 8:1") && Contains("return 2 * x"));
    CHECK_THAT(sitting.enter("nothing_like_it?"), Contains("nothing_like_it"));
    CHECK_THAT(sitting.enter("time(rrt_connect {}, 5, scenes.cup())"),
               Contains("on cup, seeds 1 to 5: 5 of 5 solved") && Contains("CPU time, ms") &&
                   Contains("(5 runs are too few for an interval)") && !Contains("inf"));
    CHECK_THAT(sitting.enter("time(rrt_connect {}, 8, scenes.cup())"),
               Contains("seeds 1 to 8: 8 of 8 solved") && !Contains("inf") && !Contains("too few"));
    CHECK_THAT(sitting.enter("time(rrt_connect {}, 0)"), Contains("at least 1, got 0"));
    sitting.enter("mine = lazy()");
    sitting.enter("mint = 1");
    sitting.terminal.type("skeleton() >> min\t >> rrt {}");
    CHECK_THAT(sitting.enter(""), Contains("lazy()"));
    sitting.terminal.type("exit\n");
    CHECK(sitting.terminal.finish() == 0);
  }
  CHECK(pipe(place, "quit\nboom\n").status == 0);
}

TEST_CASE("Ctrl-C drops a line, Ctrl-D ends the session") {
  const Place place;
  Sitting sitting(place);
  sitting.terminal.type("this is wrong");
  sitting.terminal.type(ctrl_c);
  CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt), Contains("^C") && !Contains("input"));
  // The terminal discards what was typed just before: the session may have been about to read it.
  for (int i = 0; i < 50; ++i) {
    sitting.terminal.type(std::string(static_cast<std::size_t>(i % 7 + 1), 'x'));
    sitting.terminal.type(ctrl_c);
    sitting.terminal.wait_for(Terminal::prompt);
  }
  sitting.terminal.type("x = {\n");
  sitting.terminal.wait_for("..> ");
  sitting.terminal.type(ctrl_c);
  sitting.terminal.wait_for(Terminal::prompt);
  CHECK_THAT(sitting.enter("7"), Contains("\n7\r\n"));
  sitting.terminal.type(ctrl_d);
  CHECK(sitting.terminal.finish() == 0);
}

TEST_CASE("Ctrl-C ends what runs and leaves the session") {
  const Place place;
  Sitting sitting(place);
  sitting.terminal.type("while true do end\n");
  sitting.terminal.wait_for("end\r\n");
  sitting.terminal.type(ctrl_c);
  CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt), Contains("interrupted"));

  sitting.enter(
      "closed = problem { world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 10} }, "
      "robot = robot.point(), start = {1, 1}, goal = {9, 9} }");
  sitting.terminal.type("plan(rrt { step = 0.001, proposals = 1e9 }, closed)\n");
  sitting.terminal.wait_for("closed)\r\n");
  sitting.terminal.type(ctrl_c);
  CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt), Contains("run 1") && Contains("stopped after"));
  CHECK_THAT(sitting.enter("run().status"), Contains("interrupted"));
  CHECK_THAT(sitting.enter("#samples() > 0"), Contains("true"));
}

TEST_CASE("a run is planned and inspected") {
  const Place place;
  Sitting sitting(place);
  sitting.enter("nested = skeleton() >> shrink(0.5) >> rrt { step = 0.5 }");
  CHECK_THAT(sitting.enter("plan(nested, scenes.cup(), { seed = 3 })"),
             Contains("run 1 on cup: nested, seed 3: solved by"));
  CHECK_THAT(sitting.enter("levels()"), Contains("shrink(0.5)") && Contains("all levels"));
  CHECK_THAT(sitting.enter("plot()"), Contains("┌──") && Contains("G") && Contains("level 0, root"));
  CHECK_THAT(sitting.enter("efficiency()"), Contains("own space, own path") && Contains("expansion"));
  CHECK_THAT(sitting.enter("type(run().levels[0].tree.SE)"), Contains("number"));
  CHECK_THAT(sitting.enter("run().levels[0].name, run().levels[2].name, #run().levels"),
             Contains("root\r\nskeleton()\r\n2\r\n"));
  CHECK_THAT(sitting.enter("run().levels[0].expansion.SE > 0"), Contains("true"));
  CHECK_THAT(sitting.enter("#run().path > 2, run().solved, run().seed"), Contains("true\r\ntrue\r\n3\r\n"));
  CHECK_THAT(sitting.enter("replay(run())"), Contains("run 1 again: the same"));
  CHECK_THAT(sitting.enter("run().pat"), Contains("did you mean 'path'?"));
  // The problem of the previous run is the default; a planner is a strategy.
  CHECK_THAT(sitting.enter("plan(rrt {})"), Contains("run 2 on cup: rrt(), seed 1"));
  CHECK_THAT(sitting.enter("#runs()"), Contains("\n2\r\n"));
}

TEST_CASE("a run is stepped through, proposal by proposal") {
  const Place place;
  Sitting sitting(place);
  sitting.enter("nested = skeleton() >> shrink(0.5) >> rrt { step = 0.5 }");
  CHECK_THAT(sitting.enter("start(nested, scenes.cup())"), Contains("stopped after 0 proposals"));
  CHECK_THAT(sitting.enter("where()"), Contains("nothing has been proposed yet"));
  CHECK_THAT(sitting.enter("step()"), Contains("proposal 1 of the run, number 1 of level 1, shrink(0.5)"));
  const std::string tenth = sitting.enter("step(9)");
  CHECK_THAT(tenth, Contains("proposal 10 of the run") && Contains("proposed") && Contains("became"));
  CHECK_THAT(sitting.enter("run().proposals, #samples(1, 'expansion')"), Contains("\n10\r\n10\r\n"));
  // Each step shows the same as the whole run does.
  CHECK_THAT(sitting.enter("stepped = samples(1, 'expansion')[10]"), !Contains("input"));
  CHECK_THAT(sitting.enter("continue()"), Contains("solved by"));
  CHECK_THAT(sitting.enter("table.concat(samples(1, 'expansion')[10], ' ') == table.concat(stepped, ' ')"),
             Contains("true"));
  sitting.enter("whole = run()");
  CHECK_THAT(sitting.enter("plan(nested).checks == whole.checks"), Contains("true"));
  CHECK_THAT(sitting.enter("run(1); step()"), Contains("the run has ended: solved"));
}

TEST_CASE("a run beside its unguided planner is stepped through and plotted") {
  const Place place;
  Sitting sitting(place);
  sitting.enter("start(shrink(0.5) >> rrt_connect { bound = 2 }, scenes.cup())");
  // The planner beside the guided search begins once that has done some work.
  sitting.enter("step(140)");
  // An error would end the loop before it prints what it has done.
  const std::string steps = sitting.enter("for i = 1, 30 do step() plot() end print('drew', 'each', 'step')");
  CHECK_THAT(steps, Contains("of level 0 without guides, searched by rrt_connect"));
  CHECK_THAT(steps, Contains("drew\teach\tstep"));
  CHECK_THAT(sitting.enter("continue()"), Contains("solved by"));
}

TEST_CASE("a script's strategies and problems are bound") {
  const Place place;
  place.script("two.lua",
               "spare = rrt { step = 0.1 }\n"
               "return experiment { problems = scenes.cup(), seeds = {4}, strategies = "
               "{ plain = rrt {}, ['with guide'] = skeleton() >> rrt {} } }\n");
  Sitting sitting(place, {"two.lua"});
  CHECK_THAT(sitting.greeting, Contains("script.strategies.plain") && Contains("script.strategies[\"with guide\"]") &&
                                   Contains("script.problems.cup"));
  CHECK_THAT(sitting.enter("plan(script.strategies.plain, { seed = script.seeds[1] })"),
             Contains("run 1 on cup: plain, seed 4"));
  CHECK_THAT(sitting.enter("spare"), Contains("rrt { step = 0.1 }"));
  CHECK_THAT(sitting.enter("compare(script.strategies, { seeds = 2 })"),
             Contains("summary of cup") && Contains("with guide") && Contains("compared with plain, 2 runs paired"));
  CHECK_THAT(sitting.enter("ablate(script.strategies['with guide'], { seeds = 2, measure = false })"),
             Contains("without skeleton()"));
}

TEST_CASE("the history is kept for the next session") {
  const Place place;
  {
    Sitting sitting(place);
    sitting.enter("first_thing = 11");
    sitting.terminal.type("second_thing = {\n");
    sitting.terminal.wait_for("..> ");
    sitting.enter("22 }");
    sitting.terminal.type(ctrl_d);
    CHECK(sitting.terminal.finish() == 0);
  }
  CHECK((fs::status(place / "history").permissions() & (fs::perms::group_all | fs::perms::others_all)) ==
        fs::perms::none);
  Sitting next(place);
  // Up once: the input of two lines, whole; up twice: the one before.
  next.terminal.type("\x1b[A");
  next.enter("");
  CHECK_THAT(next.enter("second_thing[1]"), Contains("\n22\r\n"));
  next.terminal.type("\x1b[A\x1b[A\x1b[A");
  next.enter("");
  CHECK_THAT(next.enter("first_thing"), Contains("\n11\r\n"));
}

TEST_CASE("a history that is no regular file, or too large, is left alone, and the session begins") {
  for (const std::string make : {"mkfifo history", "ln -s /dev/zero history", "truncate -s 3G history"}) {
    const Place place;
    REQUIRE(place.shell(make).status == 0);
    Sitting sitting(place);
    CAPTURE(make, sitting.greeting);
    CHECK_THAT(sitting.greeting, Contains("warning: there is no history: '") && Contains("history': it "));
    CHECK_THAT(sitting.enter("1 + 1"), Contains("\n2\r\n"));
    sitting.terminal.type(ctrl_d);
    CHECK(sitting.terminal.finish() == 0);
    if (make.starts_with("truncate")) CHECK(fs::file_size(place / "history") == std::uintmax_t{3} << 30U);
  }
}

TEST_CASE("the loss of a local variable is reported once") {
  const Place place;
  Sitting sitting(place);
  CHECK_THAT(sitting.enter("local y = 1"), Contains("'local y' has ended"));
  CHECK_THAT(sitting.enter("local z = 1"), !Contains("has ended"));
  CHECK_THAT(sitting.enter("y"), Contains("unknown name 'y'"));
}

TEST_CASE("an editor's text is run") {
  const Place place;
  const std::string editor = place.script("editor", "#!/bin/sh\necho 'edited = 5 * 5' >\"$1\"\n");
  fs::permissions(editor, fs::perms::owner_all);
  Sitting sitting(place, {}, editor);
  CHECK_THAT(sitting.enter("edit()"), Contains("edited = 5 * 5"));
  CHECK_THAT(sitting.enter("edited"), Contains("\n25\r\n"));
}

TEST_CASE("a script's strategy is planned on the script's problem, whatever was planned before") {
  const Place place;
  place.script("own.lua",
               "return experiment { problems = { scenes.cup(), scenes.trap() }, strategies = { plain = rrt {} } }\n");
  Sitting sitting(place, {"own.lua"});
  CHECK_THAT(sitting.enter("plan(rrt_connect {}, scenes.simple_passage())"), Contains("run 1 on simple_passage: "));
  CHECK_THAT(sitting.enter("plan(script.strategies.plain)"), Contains("run 2 on cup: plain"));
  // One of the script's problems stays; another strategy takes the last one.
  CHECK_THAT(sitting.enter("plan(script.strategies.plain, script.problems.trap)"), Contains("run 3 on trap: "));
  CHECK_THAT(sitting.enter("plan(script.strategies.plain)"), Contains("run 4 on trap: "));
  CHECK_THAT(sitting.enter("plan(rrt_connect {}, scenes.simple_passage())"), Contains("run 5 on simple_passage: "));
  CHECK_THAT(sitting.enter("plan(prm {})"), Contains("run 6 on simple_passage: "));
  CHECK_THAT(sitting.enter("compare(script.strategies.plain, rrt_connect {}, { seeds = 2, measure = false })"),
             Contains("simple_passage"));
}

TEST_CASE("what is saved after a script runs: it requires the script and returns what was planned last") {
  const Place place;
  fs::create_directory(place / "scripts");
  place.script(
      "scripts/own.lua",
      "width = 2\n"
      "return experiment { problems = scenes.trap(), strategies = { ['with guide'] = skeleton() >> rrt {} } }\n");
  {
    Sitting sitting(place, {"scripts/own.lua"});
    sitting.enter("twice = 2 * width");
    sitting.enter("plan(script.strategies['with guide'])");
    CHECK_THAT(sitting.enter("save 'kept.lua'"), Contains("kept.lua written"));
    CHECK_THAT(sitting.enter("save 'elsewhere/kept.lua'"), Contains("requires the loaded script"));
  }
  CHECK_THAT(content(place / "kept.lua"),
             Contains("\nlocal script = require \"scripts.own\"\n") &&
                 Contains("\nreturn script.strategies[\"with guide\"], script.problems.trap\n"));
  const auto outcome = place.run({"kept.lua", "--seeds", "2"});
  INFO(outcome.err);
  CHECK(outcome.status == 0);
  CHECK_THAT(outcome.out, Contains("trap") && Contains("2/2"));
}

TEST_CASE("what succeeded is saved as a script") {
  const Place place;
  {
    Sitting sitting(place);
    sitting.enter("mine = skeleton() >> rrt { step = 0.4 }");
    sitting.enter("mistake = nothing_there");
    sitting.enter("plan(mine)");
    CHECK_THAT(sitting.enter("save 'kept.lua'"), Contains("kept.lua written"));
  }
  const std::string kept = content(place / "kept.lua");
  CHECK_THAT(kept, Contains("\nmine = skeleton() >> rrt { step = 0.4 }\n") && Contains("\n-- plan(mine)\n"));
  CHECK_THAT(kept, !Contains("mistake"));
  CHECK_THAT(kept, Contains("\nreturn mine, scenes.simple_passage()\n"));
  Sitting again(place, {"kept.lua"});
  CHECK_THAT(again.enter("mine"), Contains("rrt { step = 0.4 }"));
  CHECK(place.run({"run", "kept.lua", "--quiet"}).status == 0);
}

TEST_CASE("a picture of a run is written") {
  const Place place;
  Sitting sitting(place);
  sitting.enter("plan(rrt {})");
  CHECK_THAT(sitting.enter("plot 'run.gif'"), Contains("ends with .svg, .png or .pdf"));
  if (!trellis::test::draws_figures()) return;
  CHECK_THAT(sitting.enter("plot 'run.svg'"), Contains("run.svg written"));
  CHECK_THAT(content(place / "run.svg"), Contains("<svg"));
  CHECK_THAT(sitting.enter("plot(3)"), Contains("the levels 0 to 0, got 3"));
}

TEST_CASE("a run in space is drawn as edges from a corner, and written as a picture") {
  if (!trellis::test::draws_figures()) return;
  const Place place;
  const Piped piped =
      pipe(place,
           "blocks = world { bounds = {0, 0, 0, 10, 10, 10}, box {4, 0, 0, 6, 10, 4.6}, "
           "box {4, 0, 5.4, 6, 10, 10}, sphere {2.5, 2, 2, 1} }\n"
           "plank = robot.rigid { box {-0.8, -0.5, -0.1, 0.8, 0.5, 0.1} }\n"
           "slot = problem { world = blocks, robot = plank, start = pose {1, 5, 5}, goal = pose {9, 5, 5} }\n"
           "hall = problem { world = world { bounds = {0, 0, 0, 10, 10, 4}, box {4, 4, 0, 6, 6, 3} }, "
           "robot = plank, start = pose {1, 1, 1}, goal = pose {9, 9, 3} }\n"
           "unplanned = plan(rrt_connect { proposals = 1 }, slot)\n"
           "plot()\n"
           "planned = plan(workspace() >> rrt_connect { step = 1, bound = 0 }, hall)\n"
           "plot 'hall.svg'\n"
           "plot(1)\n"
           "plot('turned.svg', 0, { azimuth = 20, elevation = 70 })\n"
           "plot(1, { azimuth = 15 })\n");
  CHECK(piped.err.empty());
  const std::size_t begin = piped.out.find("┌");
  REQUIRE(begin != std::string::npos);
  const std::size_t end = piped.out.find("elevation", begin);
  REQUIRE(end != std::string::npos);
  trellis::test::check_golden("plot_space.txt", piped.out.substr(begin, piped.out.find('\n', end) + 1 - begin));
  CHECK_THAT(piped.out,
             Contains("level 1, workspace(0): ") && Contains("a world of 10 m x 10 m x 4 m from azimuth -60"));
  CHECK_THAT(piped.out, Contains("a world of 10 m x 10 m x 4 m from azimuth 15"));
  CHECK_THAT(content(place / "hall.svg"), Contains("<svg"));
  CHECK_THAT(content(place / "turned.svg"), Contains("<svg"));
  CHECK(content(place / "turned.svg") != content(place / "hall.svg"));
}

TEST_CASE("plot draws each robot of a team with its start, goal and path") {
  if (!trellis::test::draws_figures()) return;
  const Place place;
  const Piped piped = pipe(place,
                           "r = problem { world = world { bounds = {0, 0, 10, 10} }, robot = robots { "
                           "robot.disc(0.5), count = 3 }, start = { {1, 1}, {5, 1}, {9, 1} }, goal = { {1, 9}, {5, 9}, "
                           "{9, 9} } }\n"
                           "planned = plan(prioritise() >> rrt_connect {}, r)\n"
                           "plot()\n"
                           "plot 'team.svg'\n"
                           "plot(2)\n");
  CHECK(piped.err.empty());
  const std::size_t begin = piped.out.find("┌");
  REQUIRE(begin != std::string::npos);
  const std::string first = piped.out.substr(begin, piped.out.find("level 0", begin) - begin);
  CHECK(std::count(first.begin(), first.end(), 'S') == 3);
  CHECK(std::count(first.begin(), first.end(), 'G') == 3);
  CHECK_THAT(piped.out, Contains("level 2, robot 1: "));
  // The colours of the three paths.
  const std::string svg = content(place / "team.svg");
  for (const char* colour : {"#0072b2", "#d55e00", "#009e73"}) CHECK_THAT(svg, Contains(colour));
}

TEST_CASE("a view of plot is one of a problem in space, in degrees") {
  const Place place;
  const auto error = [&](const std::string& call) {
    return pipe(place, "plan(rrt_connect {}, scenes.cup())\n" + call + "\n").err;
  };
  CHECK_THAT(error("plot { azimuth = 10 }"), Contains("level 0, root, is in the plane, which is drawn from above"));
  CHECK_THAT(error("plot { azimut = 10 }"), Contains("no option 'azimut' (did you mean 'azimuth'?)"));
  CHECK_THAT(error("plot { elevation = 91 }"),
             Contains("option 'elevation' must be a number of degrees in [-90, 90], got 91"));
}

TEST_CASE("a run of a document is replayed by the script that it names") {
  const Place place;
  place.script("s.lua",
               "return experiment { problems = scenes.cup(), seeds = 2, measure = false, "
               "strategies = { plain = rrt {} } }\n");
  REQUIRE(place.run({"run", "s.lua", "--quiet", "--json", "results.json"}).status == 0);
  Sitting sitting(place);
  CHECK_THAT(sitting.enter("replay('results.json', 2)"),
             Contains("the same as run 2 of results.json") && Contains("run 1 on cup: plain, seed 2"));
  CHECK_THAT(sitting.enter("replay('results.json', 9)"), Contains("has the runs 1 to 2, got 9"));
  place.script("s.lua", "return experiment { problems = scenes.cup(), strategies = { plain = rrt { step = 0.1 } } }\n");
  CHECK_THAT(sitting.enter("replay('results.json', 1)"), Contains("is another strategy in 's.lua' now"));
  fs::remove(place / "s.lua");
  CHECK_THAT(sitting.enter("replay('results.json', 1)"), Contains("neither there nor beside"));
}

TEST_CASE("lines that are piped are run without prompts") {
  const Place place;
  const auto fine = pipe(place, "x = 6\nfunction f()\n  return x * 7\nend\n\nf()\nhelp 'rrt'\n");
  CHECK(fine.status == 0);
  CHECK(fine.err.empty());
  CHECK_THAT(fine.out, Contains("42\n") && Contains("rrt (planner)") && !Contains("trellis>"));
  const auto wrong = pipe(place, "boom\n1 + 1\nx = {");
  CHECK(wrong.status == 2);
  CHECK(wrong.out == "2\n");
  CHECK_THAT(wrong.err, Contains("unknown name 'boom'") && Contains("near <eof>"));
}

TEST_CASE("Tab completes the fields of what an index gives, by its type") {
  const Place place;
  place.script("two.lua",
               "return experiment { problems = { scenes.cup() }, strategies = { fast = rrt { step = 0.5 } } }\n");
  Sitting sitting(place, {"two.lua"});
  sitting.terminal.type("script.problems[1].resol\t\n");
  CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt),
             Contains("script.problems[1].resolution") && Contains("\n0.05"));
  sitting.terminal.type("script.problems['cup'].world.bou\t\n");
  CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt), Contains("].world.bounds"));
  sitting.terminal.type("script.problems[1].robot:sc\t(0.5)\n");
  CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt), Contains("robot:scaled(0.5)") && Contains("robot '"));
  sitting.terminal.type("script.strategies.fast:ha\t()\n");
  CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt), Contains("fast:hash()"));
}

TEST_CASE("%time times a strategy, a run and any expression") {
  const Place place;
  Sitting sitting(place);
  sitting.enter("fast = rrt { step = 0.5 }");
  CHECK_THAT(sitting.enter("%time fast"), Contains("fast on simple_passage, seeds 1 to 10") &&
                                              Contains("CPU time, ms") && Contains("validity checks"));
  CHECK_THAT(sitting.enter("%time plan(fast, scenes.cup())"), Contains("fast on cup, seeds 1 to 10"));
  CHECK_THAT(sitting.enter("%time 1 + 1"), Contains("10 calls; median with 95 % interval") && !Contains("checks"));
  CHECK_THAT(sitting.enter("time(function() return scenes.cup() end, 20)"), Contains("20 calls; median"));
}

TEST_CASE("reload reads the script again, says what changed and keeps the session's values") {
  const Place place;
  place.script("size.lua", "return 0.4\n");
  const std::string first =
      "return experiment { problems = { scenes.cup() }, seeds = 2, strategies = { fast = rrt { step = require 'size' "
      "}, "
      "old = rrt {} } }\n";
  place.script("two.lua", first);
  Sitting sitting(place, {"two.lua"});
  sitting.enter("mine = script.strategies.fast");
  CHECK_THAT(sitting.enter("reload()"),
             Contains("two.lua read again: its strategies, problems and seeds are the same"));
  place.script("size.lua", "return 0.25\n");
  CHECK_THAT(sitting.enter("reload()"),
             Contains("script.strategies.fast is rrt { step = 0.25 }, and was rrt { step = 0.4 }") && !Contains("old"));
  place.script("two.lua",
               "local p = scenes.trap()\nreturn experiment { problems = { p }, seeds = 3, strategies = { fast = rrt { "
               "step = 0.25 }, new = rrt {} } }\n");
  CHECK_THAT(sitting.enter("reload()"),
             Contains("script.strategies.new is new") && Contains("script.strategies.old is gone") &&
                 Contains("script.problems.trap is new") && Contains("script.problems.cup is gone") &&
                 Contains("script.seeds: 3, and were 2"));
  CHECK_THAT(sitting.enter("mine"), Contains("rrt { step = 0.4 }"));
  CHECK_THAT(sitting.enter("script.strategies.new"), Contains("rrt()"));
  place.script("two.lua", "return shrink(2) >> rrtt {}, scenes.cup()\n");
  CHECK_THAT(sitting.enter("reload()"),
             Contains("two.lua:1: shrink: option 'scale'") && Contains("unknown name 'rrtt'"));
  CHECK_THAT(sitting.enter("script.strategies.new"), Contains("rrt()"));
  CHECK(pipe(place, "reload()\n").err.find("begun without a script") != std::string::npos);
}

TEST_CASE("Ctrl-C in compare keeps the seeds that are finished") {
  const Place place;
  Sitting sitting(place);
  sitting.enter("slow = rrt { step = 0.001, proposals = 3e5 }");
  sitting.enter(
      "closed = problem { world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 10} }, "
      "robot = robot.point(), start = {1, 1}, goal = {9, 9} }");
  sitting.terminal.type("compare(rrt { proposals = 10 }, slow, { problem = closed, seeds = 1000, measure = false })\n");
  sitting.terminal.wait_for("planning 4/2000");
  sitting.terminal.type(ctrl_c);
  CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt),
             Contains("interrupted; this is what was finished: seed") && Contains(" of 1000"));
  CHECK_THAT(sitting.enter("7"), Contains("\n7\r\n"));
}

TEST_CASE("a session warns of a part that nothing guides, and prints the weight that was given") {
  const Place place;
  Sitting sitting(place);
  CHECK_THAT(sitting.enter("m = skeleton() >> (shrink(0.5) + bridge_test())"),
             Contains("warning: input 1:1: 'skeleton()' does not guide bridge_test(0.5)"));
  CHECK_THAT(sitting.enter("0.3 * skeleton()"), Contains("0.3 x skeleton()"));
}

TEST_CASE("the session's words belong to the person who types, not to scripts and modules") {
  const Place place;
  place.script("victim.lua", "return 'old'\n");
  const std::string experiment = "return experiment { problems = scenes.cup(), strategies = { plain = rrt {} } }\n";
  // A script that calls a word while it loads, directly, by a module, or by what it can reach of the globals.
  place.script("thief.lua", "save 'victim.lua'\n");
  for (const std::string attack :
       {"save 'victim.lua'\n", "plot 'plot.svg'\n", "edit 'victim.lua'\n", "quit()\n", "require 'thief'\n",
        "_G.save('victim.lua')\n", "load('save [[victim.lua]]')()\n", "rawget(_G, 'save')('victim.lua')\n"}) {
    place.script("attack.lua", attack + experiment);
    const auto outcome = place.shell("VISUAL='touch started; true' $T repl attack.lua <<< '1 + 1'");
    INFO(attack << outcome.err);
    CHECK(outcome.status == 2);
    CHECK(content(place / "victim.lua") == "return 'old'\n");
    CHECK_FALSE(fs::exists(place / "plot.svg"));
    CHECK_FALSE(fs::exists(place / "started"));
  }
  // A script that calls one later: by a function that the person calls, a metamethod, a global that it replaces, or a
  // part of a strategy.
  place.script("later.lua",
               "local function steal() save 'victim.lua' end\n"
               "function innocent() steal() end\n"
               "function print() steal() end\n"
               "function save(file) error('the script has the word') end\n"
               "hidden = setmetatable({}, { __index = steal, __tostring = steal, __call = steal })\n"
               "setmetatable(string, { __index = steal })\n"
               "step = 0.25\n" +
                   experiment);
  Sitting sitting(place, {"later.lua"}, "touch started; true");
  CHECK_THAT(sitting.greeting, Contains("_G.save") && Contains("is the script's; save is the session's word here") &&
                                   Contains("_G.step"));
  CHECK_THAT(sitting.enter("innocent()"), Contains("the script has the word"));
  CHECK_THAT(sitting.enter("print(1)"), Contains("the script has the word"));
  sitting.enter("hidden");
  sitting.enter("hidden.field");
  sitting.enter("hidden()");
  CHECK(content(place / "victim.lua") == "return 'old'\n");
  // The person has the words, under the script's names too, and all globals.
  CHECK_THAT(sitting.enter("_G.step"), Contains("\n0.25\r\n"));
  CHECK_THAT(sitting.enter("plan(script.strategies.plain)"), Contains("run 1 on cup: plain"));
  CHECK_THAT(sitting.enter("save 'mine.lua'"), Contains("mine.lua written"));
  CHECK_THAT(sitting.enter("sav 'mine.lua'"), Contains("unknown name 'sav' (did you mean 'save'?)"));
  sitting.terminal.type("compa\t(1)");
  CHECK_THAT(sitting.enter(""), Contains("compare(1)") && Contains("a strategy belongs here"));
  CHECK_FALSE(fs::exists(place / "started"));
}

TEST_CASE("what is saved gives every value again: lists, texts, problems and worlds of runs, typed problems") {
  const Place place;
  const Piped session =
      pipe(place,
           "w = world { bounds = {0, 0, 10, 10}, box { 4, 0, 5, 6, name = 'wall' } }\n"
           "p = problem { name = 'mine', world = w, robot = robot.disc(0.2), start = {1, 1}, goal = {9, 1} }\n"
           "r = plan(skeleton() >> rrt { step = 0.4 }, p)\n"
           "path = r.path half = r.length / 2 text = tostring(r.seed) .. ' \"seed\"'\n"
           "table_of = { path = { r.path[1] }, ['two words'] = true }\n"
           "again = r.problem\n"
           "g = along(path)\n"
           "a = g >> rrt { step = 0.4 } plan(a, p) third = 1/3\n"
           "made = plan(rrt {}, problem { world = world { bounds = {0, 0, 5, 5}, disc { 2, 2, 0.5 } },\n"
           "  robot = robot.point(), start = {1, 1}, goal = {4, 4} }, { seed = 5 }).problem.world\n"
           "save 'kept.lua'\n");
  CHECK(session.err.empty());
  const std::string kept = content(place / "kept.lua");
  INFO(kept);
  CHECK_THAT(kept, Contains("\nagain = p\n") && Contains("\ng = along(path)\n") && Contains("\nthird = 1/3\n"));
  CHECK_THAT(kept, Contains("\nmade = world { bounds = {0, 0, 5, 5}, disc { 2, 2, 0.5 } }\n"));
  CHECK_THAT(kept, Contains("seeds = { 5 } }\n") && Contains("robot = robot.point(), start = {1, 1}, goal = {4, 4} }"));
  const trellis::test::Outcome run = place.run({"run", "kept.lua", "--report", "levels"});
  CHECK(run.status == 0);
  CHECK_THAT(run.out, Contains("1 seed (5)"));
  // The values are the same, to the last bit.
  place.script("compare.lua",
               "require 'kept'\n"
               "assert(#path > 2 and half > 5 and third == 1 / 3 and text == '1 \"seed\"')\n"
               "assert(table_of['two words'] and table_of.path[1][1] == path[1][1])\n"
               "return a, again\n");
  const Piped more = pipe(place, "require 'compare' q = plan(a, again) print(q.length == half * 2, #q.path)\n");
  CHECK(more.err.empty());
}

TEST_CASE("numbers print as people write them") {
  const Place place;
  const Piped session = pipe(
      place, "0.1 + 0.2\n1e3\n2^53\n2.5e-7\n1e100\n{ 0.1 + 0.2, 1000.0, 100000 * 10.0, 1/3, 2.5e-7, 1234567.8 }\n");
  CHECK(session.out ==
        "0.3\n1000\n9.007199254741e15\n2.5e-7\n1e100\n{ 0.3, 1000, 1000000, 0.333333, 2.5e-7, 1234568 }\n");
}

TEST_CASE("save replaces a file that the session did not write only if the person says so") {
  const Place place;
  place.script("there.lua", "return 'old'\n");
  const Piped refused = pipe(place, "x = 1\nsave 'there.lua'\nsave 'mine.lua'\ny = 2\nsave 'mine.lua'\n");
  CHECK(refused.status == 2);
  CHECK_THAT(refused.err,
             Contains("save: 'there.lua' is there, and this session did not write it; it is left as it is"));
  CHECK(content(place / "there.lua") == "return 'old'\n");
  CHECK_THAT(content(place / "mine.lua"), Contains("\ny = 2\n"));  // its own, twice
  Sitting sitting(place);
  sitting.enter("x = 1");
  for (const std::string no : {"\n", "n\n", "Y\n", ctrl_c}) {
    sitting.terminal.type("save 'there.lua'\n");
    sitting.terminal.wait_for("'there.lua' is there, and this session did not write it. Replace it? [y/N] ");
    sitting.terminal.type(no);
    CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt), Contains("it is left as it is"));
    CHECK(content(place / "there.lua") == "return 'old'\n");
  }
  sitting.terminal.type("save 'there.lua'\n");
  sitting.terminal.wait_for("[y/N] ");
  sitting.terminal.type("y\n");
  CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt), Contains("there.lua written"));
  CHECK_THAT(content(place / "there.lua"), Contains("\nx = 1\n"));
  CHECK_THAT(sitting.enter("save 'there.lua'"), Contains("there.lua written"));
  place.script("there.lua", "return 'changed by another program'\n");
  sitting.terminal.type("save 'there.lua'\n");
  sitting.terminal.wait_for("'there.lua' has changed since this session wrote it. Replace it? [y/N] ");
  sitting.terminal.type("\n");
  CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt), Contains("it is left as it is"));
  CHECK(content(place / "there.lua") == "return 'changed by another program'\n");
}

TEST_CASE("plot replaces a file that the session did not write only if the person says so") {
  const Place place;
  for (const std::string ending : {"svg", "png", "pdf"}) {
    const std::string there = "there." + ending;
    const std::string mine = "mine." + ending;
    place.script(there, "a picture of the person");
    const Piped refused = pipe(place, "plan(rrt {})\nplot '" + there + "'\nplot '" + mine + "'\nplot '" + mine + "'\n");
    INFO(ending << ": " << refused.err);
    CHECK(refused.status == 2);
    CHECK_THAT(refused.err, Contains("plot: '" + there +
                                     "' is there, and this session did not write it; it is left "
                                     "as it is: plot under another name") &&
                                !Contains(mine));
    CHECK(content(place / there) == "a picture of the person");
    CHECK(content(place / mine).size() > 100);  // its own, twice
  }
  Sitting sitting(place);
  sitting.enter("plan(rrt {})");
  for (const std::string no : {"\n", "n\n", ctrl_c}) {
    sitting.terminal.type("plot 'there.svg'\n");
    sitting.terminal.wait_for("'there.svg' is there, and this session did not write it. Replace it? [y/N] ");
    sitting.terminal.type(no);
    CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt), Contains("it is left as it is"));
    CHECK(content(place / "there.svg") == "a picture of the person");
  }
  sitting.terminal.type("plot 'there.svg'\n");
  sitting.terminal.wait_for("[y/N] ");
  sitting.terminal.type("y\n");
  CHECK_THAT(sitting.terminal.wait_for(Terminal::prompt), Contains("there.svg written"));
  CHECK_THAT(content(place / "there.svg"), Contains("<svg"));
  CHECK_THAT(sitting.enter("plot 'there.svg'"), Contains("there.svg written"));
  // A wrong name is an error before the question.
  place.script("there.gif", "a picture of the person");
  CHECK_THAT(sitting.enter("plot 'there.gif'"), Contains("ends with .svg, .png or .pdf"));
}

TEST_CASE("what is saved after tune, and after values of runs, is a script that runs") {
  const Place place;
  const std::string tuning =
      "tune(function(p) return rrt { step = p.step } end, scenes.cup(), { over = { step = {0.2, 0.25} }, budget = 24 "
      "})";
  for (const std::string& inputs : std::vector<std::string>{
           tuning, "best = " + tuning, "best = " + tuning + "\nplan(best)",
           "best = " + tuning + "\nworse = best\nplan(skeleton() >> worse, scenes.trap())",
           "mine = rrt { step = 0.5 }\nr = plan(mine, scenes.cup())\nlength = r.length\nshorter = length / 2\n"
           "plan(mine, scenes.cup())"}) {
    const Piped session = pipe(place, inputs + "\nsave 'kept.lua'\n");
    INFO(inputs << "\n" << session.err << content(place / "kept.lua"));
    CHECK(session.status == 0);
    const auto outcome = place.run({"run", "kept.lua", "--quiet"});
    INFO(outcome.err);
    CHECK(outcome.status == 0);
    fs::remove(place / "kept.lua");
  }
  pipe(place, "best = " + tuning + "\nsave 'kept.lua'\n");
  CHECK_THAT(content(place / "kept.lua"), Contains("\nbest = rrt { step = ") && Contains(" }, scenes.cup()\n"));
}
