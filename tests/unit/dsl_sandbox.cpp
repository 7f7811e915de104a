// SPDX-License-Identifier: GPL-3.0-or-later
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <lua.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "support/catch.hpp"
#include "support/script.hpp"

#include <dsl/lua/state.hpp>

namespace fs = std::filesystem;
using namespace trellis;
using test::failure;
using test::value;
using test::values;

namespace {

/// A temporary folder.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("trellis-dsl-" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string write(const std::string& name, const std::string& text) const {
    fs::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name) << text;
    return (path_ / name).string();
  }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  fs::path path_;
};

}  // namespace

TEST_CASE("scripts reach no files, processes, bytecode or internals") {
  for (const std::string name : {"io", "os", "debug", "package", "dofile", "loadfile"}) {
    INFO(name);
    CHECK(failure("return " + name).find("there is no '" + name + "' here") != std::string::npos);
  }
  CHECK(value("string.dump") == "nil");
  CHECK(failure("return load('\\27Lua', 'x', 'b')").find("bytecode") != std::string::npos);
  CHECK(value("(load('\\27Lua'))") == "nil");
  CHECK(value("load('return 1 + 1')()") == "2");
  CHECK(value("load('return x', 'chunk', 't', { x = 5 })()") == "5");
  CHECK(value("getmetatable(rrt {})") == "planner");
  CHECK(value("getmetatable(_G)") == "false");
  CHECK(failure("setmetatable(_G, nil)").find("protected") != std::string::npos);
}

TEST_CASE("the rest of Lua is there") {
  CHECK(value("table.concat({1, 2, 3}, ',')") == "1,2,3");
  CHECK(value("('abc'):upper()") == "ABC");
  CHECK(value("utf8.len('ä')") == "1");
  CHECK(value("math.max(1, 2)") == "2");
  CHECK(value("select('#', pcall(error))") == "2");
  CHECK(value("coroutine.wrap(function() coroutine.yield(7) end)()") == "7");
}

TEST_CASE("trusted scripts reach files, processes and the interpreter, bytecode stays out") {
  const dsl::SessionOptions trusted{.trust = true};
  for (const std::string name : {"io.open", "os.time", "debug.traceback"}) {
    INFO(name);
    CHECK(value("type(" + name + ")", trusted) == "function");
  }
  CHECK(value("string.dump", trusted) == "nil");
  CHECK(failure("return package", trusted).find("there is no 'package' here") != std::string::npos);
  CHECK(value("scenes.exists '/etc/passwd'", trusted) == "true");
  CHECK(failure("return scenes.exists '/etc/passwd'").find("--trust") != std::string::npos);
}

TEST_CASE("the functions that are made anew do what Lua's do") {
  CHECK(value("table.concat({1, 'b', 2.5}, '-', 2)") == "b-2.5");
  CHECK(failure("table.concat({1, {}})").find("invalid value (at index 2) in table for 'concat'") != std::string::npos);
  CHECK(value("table.concat(table.move({1, 2, 3, 4}, 2, 4, 1), ',')") == "2,3,4,4");
  CHECK(value("table.concat(table.move({1, 2, 3, 4}, 1, 3, 2), ',')") == "1,1,2,3");
  CHECK(value("table.concat(table.move({1, 2}, 1, 2, 2, {'x'}), ',')") == "x,1,2");
  CHECK(values("local t = {1, 2} table.insert(t, 3) table.insert(t, 1, 0) local r = table.remove(t, 2) "
               "return table.concat(t, ','), r, table.remove(t), table.remove({})") ==
        std::vector<std::string>{"0,2,3", "1", "3", "nil"});
  CHECK(failure("table.insert({}, 5, 1)").find("bad argument #2 to 'insert' (position out of bounds)") !=
        std::string::npos);
  CHECK(values("local t = {} for i = 1, 1000 do t[i] = i * 7919 % 1009 end table.sort(t) "
               "for i = 2, #t do if t[i] < t[i - 1] then return 'out of order' end end "
               "table.sort(t, function(a, b) return a > b end) return t[1] > t[1000]") ==
        std::vector<std::string>{"true"});
  CHECK(failure("table.sort { 1, 'a' }").find("attempt to compare") != std::string::npos);
  CHECK(values("return ('ab'):rep(3, '-'), ('x'):rep(0), ('x'):rep(-1)") ==
        std::vector<std::string>{"ab-ab-ab", "", ""});
  CHECK(values("local t = {} for k, v in pairs({ 5, a = 1 }) do t[#t + 1] = tostring(k) .. v end "
               "return table.concat(t, ','), next({})") == std::vector<std::string>{"15,a1", "nil"});
  CHECK(values("return xpcall(error, function(e) return e .. '!' end, 'no')") ==
        std::vector<std::string>{"false", "no!"});
  CHECK(values("return select('#', pcall(function() return 1, nil end)), pcall(error)") ==
        std::vector<std::string>{"3", "false", "nil"});
  // A coroutine may yield across what was protected in it.
  CHECK(values("local co = coroutine.wrap(function() return pcall(function() coroutine.yield(1) error('late', 0) end) "
               "end) return co(), co()") == std::vector<std::string>{"1", "false", "late"});
  CHECK(values("local co = coroutine.create(function(a) local b = coroutine.yield(a + 1) return a + b end) "
               "local _, x = coroutine.resume(co, 1) local _, y = coroutine.resume(co, 5) "
               "return x, y, coroutine.status(co), coroutine.resume(co)") ==
        std::vector<std::string>{"2", "6", "dead", "false", "cannot resume dead coroutine"});
  CHECK(values("local co = coroutine.create(function() coroutine.yield() end) coroutine.resume(co) "
               "return coroutine.close(co), coroutine.status(co)") == std::vector<std::string>{"true", "dead"});
  CHECK(failure("coroutine.wrap(function() error('inside') end)()").find("test.lua:1: inside") == 0);
  CHECK(values("local t = setmetatable({}, { __index = { x = 1 } }) return t.x, getmetatable(t).__index.x") ==
        std::vector<std::string>{"1", "1"});
}

TEST_CASE("patterns match as Lua's") {
  std::ifstream file(fs::path(TRELLIS_SOURCE) / "tests/golden/patterns_driver.lua");
  std::stringstream driver;
  driver << file.rdbuf();
  const auto found = values(driver.str());
  REQUIRE(found.size() == 1);
  // Lua with its own library.
  const std::unique_ptr<lua_State, decltype(&lua_close)> lua(luaL_newstate(), &lua_close);
  luaL_openlibs(lua.get());
  REQUIRE(luaL_loadstring(lua.get(), driver.str().c_str()) == LUA_OK);
  REQUIRE(lua_pcall(lua.get(), 0, 1, 0) == LUA_OK);
  const char* expected = lua_tostring(lua.get(), -1);
  REQUIRE(expected != nullptr);
  CHECK(found.front() == expected);
}

TEST_CASE("what a script works is counted, and has an end") {
  const dsl::SessionOptions little{.instructions = 100'000};
  CHECK(value("#('x'):rep(1000)", little) == "1000");
  CHECK(failure("for _ = 1, 1e9 do end", little)
            .starts_with("test.lua:1: the script has spent 100000 instructions and does not terminate"));
  // The same script ends at the same instruction on every machine.
  const std::string counts = "n = 0 while true do n = n + 1 end";
  dsl::Session first("", little), second("", little);
  CHECK_THROWS_AS(first.evaluate(counts, "test.lua"), Error);
  CHECK_THROWS_AS(second.evaluate(counts, "test.lua"), Error);
  CHECK(first.evaluate("return n", "test.lua") == second.evaluate("return n", "test.lua"));
  // Slow checks shorten the intervals between them, and do not move the end.
  dsl::SessionOptions slow = little;
  int polls = 0;
  slow.interrupted = [&polls] {
    if (++polls % 97 < 2) std::this_thread::sleep_for(std::chrono::milliseconds(15));
    return false;
  };
  dsl::Session third("", slow);
  CHECK_THROWS_AS(third.evaluate(counts, "test.lua"), Error);
  CHECK(polls > 1050);  // 1000 intervals, and shorter ones
  CHECK(first.evaluate("return n", "test.lua") == third.evaluate("return n", "test.lua"));
}

TEST_CASE("a deep recursion is not checked more often because other processes had the processor at times") {
  const auto polls_of = [](bool busy) {
    int polls = 0;
    dsl::SessionOptions options;
    options.interrupted = [&] {
      if (++polls % 2000 == 0 && busy) std::this_thread::sleep_for(std::chrono::milliseconds(15));
      return false;
    };
    dsl::Session session("", options);
    CHECK_THROWS_WITH(session.evaluate("local function f() return 1 + f() end f()", "test.lua"),
                      Catch::Matchers::Contains("stack overflow"));
    return polls;
  };
  // Without the few intervals that really are slow.
  CHECK(polls_of(true) < polls_of(false) + 45);
}

TEST_CASE("names that nothing has are found in functions that are never called") {
  const auto unknown = [](const std::string& text) {
    dsl::Session session("");
    session.evaluate(text, "test.lua");
    return session.unknown_names(text, "test.lua");
  };
  using Messages = std::vector<std::string>;
  CHECK(unknown("local function f(a) return a + math.pi, scenes, strategies end").empty());
  CHECK(unknown("\nlocal function f()\n  return rtr {}\nend") ==
        Messages{"test.lua:3: unknown name 'rtr' (did you mean 'rrt'?)"});
  CHECK(unknown("local function f()\n return function()\n\n return nowhere\n end\n end")
            .front()
            .starts_with("test.lua:4: unknown name 'nowhere'"));
  // A name that is set anywhere is defined; a local or a field is no global.
  CHECK(unknown("local function set() later = 1 end local function get() return later end").empty());
  CHECK(unknown("local t = { inside = 1 } local function f(inside) local x = inside return x, t.inside end").empty());
  // Line numbers are correct after long gaps too.
  const std::string text =
      "local function f()\n do\n local x\n" + std::string(400, '\n') + " x = 1\n end\n return nowhere\nend";
  CHECK(unknown(text).front().starts_with("test.lua:406: unknown name 'nowhere'"));
}

TEST_CASE("the caller can end a script") {
  int asked = 0;
  dsl::Session session("", {.interrupted = [&asked] { return ++asked > 3; }});
  CHECK_THROWS_AS(session.evaluate("while true do pcall(function() while true do end end) end", "test.lua"),
                  Interrupted);
}

TEST_CASE("an unknown global is an error with the nearest name, a new one can be set") {
  CHECK(failure("return rtr").find("unknown name 'rtr' (did you mean 'rrt'?)") != std::string::npos);
  CHECK(failure("return scene").find("did you mean 'scenes'?") != std::string::npos);
  CHECK(values("answer = 42 return answer, rawget(_G, 'nothing')") == std::vector<std::string>{"42", "nil"});
}

TEST_CASE("math.random follows the seed and keeps Lua's meaning") {
  const std::string draw = "math.random(), math.random(6), math.random(-3, 3), math.random(0)";
  CHECK(values("return " + draw) == values("return " + draw));
  CHECK(values("return " + draw, {.seed = 1}) == values("return " + draw));
  CHECK(values("return " + draw, {.seed = 2}) != values("return " + draw));
  CHECK(values("math.randomseed(2) return " + draw) == values("return " + draw, {.seed = 2}));
  CHECK(values("math.random() math.randomseed() return " + draw) == values("return " + draw));
  CHECK(values("math.randomseed(3.0) return " + draw) == values("math.randomseed(3) return " + draw));
  CHECK(value("(function() for _ = 1, 1000 do local x, k, m = math.random(), math.random(6), math.random(-3, 3) "
              "if x < 0 or x >= 1 or k < 1 or k > 6 or m < -3 or m > 3 or math.type(k) ~= 'integer' then return 'out' "
              "end end return 'in' end)()") == "in");
  CHECK(value("math.type(math.random(math.mininteger, math.maxinteger))") == "integer");
  CHECK(value("math.random(5, 5)") == "5");
  CHECK(failure("math.random(2, 1)").find("the interval from 2 to 1 is empty") != std::string::npos);
  CHECK(failure("math.random(1.5)").find("must be an integer, got 1.5") != std::string::npos);
  CHECK(failure("math.random(1, 2, 3)").find("at most 2 arguments") != std::string::npos);
}

TEST_CASE("memory has a limit, and the interpreter lives on") {
  dsl::Session session("", {.memory = std::size_t{16} << 20U});
  const auto greedy = [&] { session.evaluate("local t = {} for i = 1, 1e9 do t[i] = {i} end", "test.lua"); };
  CHECK_THROWS_WITH(greedy(), "the script needs more memory than the 16 MiB it may use");
  CHECK(session.evaluate("return 1", "test.lua").front() == "1");
}

TEST_CASE("infinite recursion is an error") {
  // With sanitizers it takes nine seconds of CPU, and more on a busy machine.
  CHECK(
      failure("local function f() return 1 + f() end f()", {.instructions = 100'000'000'000}).find("stack overflow") !=
      std::string::npos);
  CHECK(failure("local t = {} t.__index = function(_, k) return t[k] end setmetatable(t, t) return t.x")
            .find("overflow") != std::string::npos);
  CHECK(failure("local t = {} for i = 1, 1e5 do t = {t} end "
                "return experiment { problems = t, strategies = { a = rrt {} } }")
            .find("nested over") != std::string::npos);
}

TEST_CASE("what a script throws comes with a traceback, what we say does not") {
  CHECK(failure("local function f() error('no luck') end\nf()") ==
        "test.lua:1: no luck\nstack traceback:\n\ttest.lua:1: in local 'f'\n\ttest.lua:2: in main chunk");
  // Without a traceback, where it would only repeat the line.
  CHECK(failure("error('no luck')") == "test.lua:1: no luck");
  CHECK(failure("rrt { step = -1 }").find("traceback") == std::string::npos);
  CHECK(failure("error(setmetatable({}, { __tostring = function() return 'odd' end }))")
            .starts_with("odd\nstack traceback:\n\ttest.lua:1: in main chunk"));
}

TEST_CASE("modules come from the standard library and the script's folder, each once") {
  const Folder folder;
  folder.write("mine.lua", "loads = (rawget(_G, 'loads') or 0) + 1\nreturn { name = ..., step = 0.5 }");
  folder.write("deep/er.lua", "return 'deeper'");
  folder.write("a.lua", "return require 'b'");
  folder.write("b.lua", "return require 'a'");
  folder.write("wrong.lua", "\nreturn shrink(7)");
  folder.write("broken.lua", "\n\nlocal = 3");
  folder.write("silent.lua", "");
  dsl::Session session(folder.path());
  const auto evaluate = [&](const std::string& text) { return session.evaluate(text, "test.lua").front(); };
  CHECK(evaluate("return require('mine').step + require('mine').step") == "1.0");
  CHECK(evaluate("return require('mine').name") == "mine");
  CHECK(evaluate("return loads") == "1");
  CHECK(evaluate("return require 'deep.er'") == "deeper");
  CHECK(evaluate("return require 'silent'") == "true");
  CHECK(evaluate("return require 'scenes' == scenes") == "true");
  CHECK(evaluate("return tostring(strategies.nested())") ==
        evaluate("return tostring(skeleton() >> shrink(0.5) >> lazy() >> rrt { step = 0.5 })"));
  CHECK_THROWS_WITH(evaluate("require 'a'"), Catch::Contains("in a cycle: a -> b -> a"));
  CHECK_THROWS_WITH(evaluate("require 'wrong'"), Catch::Contains("wrong.lua:2: shrink: option 'scale'"));
  CHECK_THROWS_WITH(evaluate("require 'broken'"), Catch::Contains("broken.lua:3: "));
  CHECK_THROWS_WITH(evaluate("require 'mien'"), Catch::Contains("no module 'mien'"));
  CHECK_THROWS_WITH(evaluate("require '..secrets'"), Catch::Contains("no module name"));
}

TEST_CASE("a fault of ours is not hidden by a script that catches everything") {
  lua::State state({.memory = std::size_t{16} << 20U});
  const auto run = [&] {
    state.run([](lua::Stack& stack) {
      lua::open_libraries(stack);
      stack.push_function([](lua::Stack&) -> int { throw std::logic_error("broken"); });
      stack.set_global("break_it");
      stack.load("pcall(break_it) return 1", "@test.lua");
      stack.call(0);
    });
  };
  CHECK_THROWS_AS(run(), std::logic_error);
}

TEST_CASE("C++ objects are destroyed when a Lua error passes them") {
  struct Witness {
    int* count;
    explicit Witness(int* c) : count(c) {}
    ~Witness() { ++*count; }
  };
  int destroyed = 0;
  lua::State state({.memory = std::size_t{16} << 20U});
  state.run([&](lua::Stack& stack) {
    lua::open_libraries(stack);
    stack.push_function([&](lua::Stack& call) {
      const Witness witness(&destroyed);
      call.load("error('out')", "@inner.lua");
      call.call(0);
      return 0;
    });
    stack.set_global("call_out");
    stack.load("return pcall(call_out)", "@test.lua");
    stack.call(0);
  });
  CHECK(destroyed == 1);
}

TEST_CASE("chains of coroutines that close each other end, however long") {
  // Each of them has a variable whose closing closes the one before.
  const std::string chain =
      "local function chain(count, wrong) local last "
      "for i = 1, count do local before = last "
      "last = coroutine.create(function() local x <close> = setmetatable({}, { __close = function() "
      "if before then coroutine.close(before) end if wrong then error('at ' .. i, 0) end end }) "
      "coroutine.yield() end) coroutine.resume(last) end return last end ";
  CHECK(values(chain + "return coroutine.close(chain(50))") == std::vector<std::string>{"true"});
  CHECK(values(chain + "return coroutine.close(chain(50, true))") == std::vector<std::string>{"false", "at 50"});
  CHECK(values(chain + "return type(coroutine.close(chain(200000)))") == std::vector<std::string>{"boolean"});
  CHECK(values(chain + "return (('x'):gsub('x', function() coroutine.close(chain(30000)) return 'closed' end))") ==
        std::vector<std::string>{"closed"});
  CHECK(values(chain +
               "local t = {3, 1, 2} table.sort(t, function(a, b) coroutine.close(chain(10000)) return a < b end) "
               "return t[1]") == std::vector<std::string>{"1"});
  // The one that is too deep receives an error; what it does not close stays open.
  const std::string deepest =
      "local why local last for i = 1, 1000 do local before = last "
      "last = coroutine.create(function() local x <close> = setmetatable({}, { __close = function() "
      "if before then local good, e = pcall(coroutine.close, before) if not good then why = e end end end }) "
      "coroutine.yield() end) coroutine.resume(last) end coroutine.close(last) return why";
  CHECK(values(deepest).front().find("coroutines close each other, more than 100 deep") != std::string::npos);
  // The error of a coroutine that coroutine.wrap made closes its variables, too.
  CHECK(values("local last for i = 1, 30000 do local before = last "
               "local run = coroutine.wrap(function() local x <close> = setmetatable({}, { __close = function() "
               "if before then pcall(before) end end }) coroutine.yield() error('end') end) run() last = run end "
               "return pcall(last)")
            .front() == "false");
}

TEST_CASE("lists that share tables are read up to a limit of values") {
  CHECK(
      failure("local t = box {4, 0, 6, 4} for i = 1, 40 do t = {t, t} end return world { bounds = {0, 0, 10, 10}, t }")
          .find("world: the lists have over 1500000 values; a table that is in several lists counts in each") !=
      std::string::npos);
  CHECK(failure("local t = {} for i = 1, 40 do t = {t, t} end return world { bounds = {0, 0, 10, 10}, t }")
            .find("world: the lists have over 1500000 values") != std::string::npos);
  CHECK(failure("local t = box {4, 0, 6, 4} for i = 1, 40 do t = {t, t} end return robot.rigid(t)")
            .find("robot.rigid: the lists have over 1500000 values") != std::string::npos);
  const std::string problems =
      "for i = 1, 40 do t = {t, t} end "
      "return experiment { problems = t, strategies = { rrt {} } }";
  for (const std::string leaf : {"scenes.cup()", "{}"}) {
    CHECK(failure("local t = " + leaf + " " + problems).find("experiment: the lists have over 100000 values") !=
          std::string::npos);
  }
  CHECK(failure("local t = 5 " + problems).find("must be a problem or a list of problems, got 5") != std::string::npos);
}
