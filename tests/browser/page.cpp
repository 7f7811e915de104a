// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the page of `trellis run --html` in a headless browser with --samples and --json of the same runs. Skipped,
// with a message, where there is no Chromium (scripts/setup browser).
//
// With TRELLIS_SCREENSHOTS=FOLDER the test stores its screenshots there, for inspection.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/process.hpp"
#include "support/results.hpp"

using Json = nlohmann::json;
using trellis::test::content;
using trellis::test::Place;
namespace fs = std::filesystem;

namespace {

std::string browser() {
  if (const char* named = std::getenv("TRELLIS_BROWSER")) return named;
  for (const char* path : {"/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"}) {
    if (fs::exists(path)) return path;
  }
  return "";
}

bool browser_is_here() {
  if (!browser().empty()) return true;
  WARN("skipped: there is no Chromium here (scripts/setup browser installs it)");
  return false;
}

/// Opens a file of the folder in the browser; returns the printed text.
std::string browse(const Place& place, const std::string& file, const std::string& arguments) {
  // A proxy without a server disables the network.
  const std::string command =
      browser() + " --headless=new --no-sandbox --disable-gpu --disable-extensions --no-first-run --hide-scrollbars" +
      " --proxy-server=127.0.0.1:9 --user-data-dir='" + (place / "profile") + "' --virtual-time-budget=60000 " +
      arguments + " 'file://" + (place / "") + file + "' >'" + (place / "dom") + "' 2>'" + (place / "chromium.err") +
      "'";
  INFO(command);
  REQUIRE(std::system(command.c_str()) == 0);  // NOLINT(cert-env33-c): a command of our own
  return content(place / "dom");
}

/// The steps, by name: the address's part behind '#', then lines of script that simulate the user.
struct Step {
  std::string name;
  std::string hash;
  std::string hands = "";
};

/// The state of the page after a step.
struct Shown {
  Json data;    ///< attributes of the viewer
  Json sample;  ///< what the panel says of the sample, by term
  std::string tip;
  std::string title;

  [[nodiscard]] std::string operator[](const std::string& name) const {
    return data.contains(name) ? data[name].get<std::string>() : "";
  }
  [[nodiscard]] std::string said(const std::string& term) const {
    return sample.contains(term) ? sample[term].get<std::string>() : "";
  }
};

std::map<std::string, Shown> perform(const Place& place, const std::vector<Step>& steps) {
  // The page with an additional script, which runs the steps and appends the results.
  std::string page = content(place / "report.html");
  std::string lines;
  for (const Step& step : steps) {
    lines += "await step(" + Json(step.name).dump() + ", " + Json(step.hash).dump() + ", async () => {" + step.hands +
             "});\n";
  }
  page.insert(page.rfind("</body>"), R"(<script>
(async () => {
  document.getElementById('fold-runs').open = true;
  const view = document.getElementById('viewer'), all = {}, wait = ms => new Promise(done => setTimeout(done, ms));
  const press = (...keys) => { for (const key of keys) document.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true})); };
  const canvasWidth = id => document.getElementById(id).clientWidth;
  const step = async (name, hash, hands) => {
    location.hash = hash;
    await wait(60);
    await hands();
    const sample = {};
    for (const term of document.querySelectorAll('#sample dt')) sample[term.textContent] = term.nextSibling.textContent;
    const tip = document.getElementById('tip');
    all[name] = {data: {...view.dataset}, sample, tip: tip.hidden ? '' : tip.textContent, title: document.title};
  };
)" + lines + R"(
  const out = document.createElement('script');
  out.type = 'application/json';
  out.id = 'steps';
  out.textContent = JSON.stringify(all).replaceAll('<', '\\u003c');
  document.body.append(out);
})();
</script>
)");
  std::ofstream(place / "steps.html") << page;
  const std::string dom = browse(place, "steps.html", "--dump-dom");
  const std::string head = "id=\"steps\">";
  const std::size_t begin = dom.rfind(head);
  REQUIRE(begin != std::string::npos);
  const std::size_t from = begin + head.size();
  std::map<std::string, Shown> shown;
  const Json seen = Json::parse(dom.substr(from, dom.find("</script>", from) - from));
  for (const auto& [name, entry] : seen.items()) {
    shown[name] = {entry["data"], entry["sample"], entry["tip"], entry["title"]};
    CAPTURE(name);
    CHECK(shown[name]["error"].empty());
    CHECK(shown[name]["ready"] == "1");
  }
  REQUIRE(shown.size() == steps.size());
  return shown;
}

struct Sample {
  bool accepted = false;
  std::vector<double> q;
};

/// The rows of samples.csv of one level and role.
std::vector<Sample> samples(const std::string& file, const std::string& level, const std::string& role) {
  std::vector<Sample> rows;
  std::istringstream lines(content(file));
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells.size() < 5 || cells[0] != level || cells[1] != role) continue;
    Sample sample{cells[3] == "1", {}};
    for (std::size_t j = 4; j < cells.size(); ++j) {
      if (!cells[j].empty()) sample.q.push_back(std::stod(cells[j]));
    }
    rows.push_back(std::move(sample));
  }
  return rows;
}

std::vector<std::size_t> counts(const std::string& text) {
  std::vector<std::size_t> out;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) out.push_back(std::stoul(part));
  return out;
}

constexpr const char* script = R"(
local nested = skeleton() >> shrink(0.5) >> lazy() >> rrt { step = 0.5 }
local mixed = (0.7 * skeleton() + 0.3 * goal_bias(0.2)) >> rrt { step = 0.5 }
return experiment {
  problems = { scenes.simple_passage(), scenes.cup() },
  strategies = {
    { "hopeless", rrt { step = 0.5, proposals = 20 } },
    { "rrt", rrt { step = 0.5 } },
    { "nested", nested },
    { "mixed", mixed },
    { "</script><script>document.title='caught'</script>", prm {} },
  },
  seeds = 2,
  measure = tube { points = 256, pool = 1024, delta = 0.5 },
}
)";

}  // namespace

TEST_CASE("the page shows what its address says, as the other files have it, and does what hands ask",
          "[browser][slow]") {
  if (!browser_is_here()) return;
  const Place place;
  place.script("script.lua", script);
  const auto outcome = place.run(
      {"run", "script.lua", "--quiet", "--html", "report.html", "--samples", "samples", "--json", "all.json"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  const Json document = trellis::test::with_levels(Json::parse(content(place / "all.json")));
  const auto run_of = [&](const std::string& problem, const std::string& strategy, int seed) {
    for (const auto& run : document["runs"]) {
      if (run["problem"] == problem && run["strategy"] == strategy && run["seed"] == seed) return run;
    }
    return Json();
  };

  const std::string click = R"(
    const canvas = document.getElementById('canvas'), box = canvas.getBoundingClientRect();
    const scale = Math.min(box.width - 16, box.height - 16) / 10;  // the world is 10 x 10
    const at = {clientX: box.left + box.width / 2 + (1 - 5) * scale, clientY: box.top + box.height / 2 - (8.5 - 5) * scale,
                bubbles: true, buttons: 1};
    for (const kind of ['pointerdown', 'pointermove', 'pointerup']) canvas.dispatchEvent(new PointerEvent(kind, at));)";
  // The page's clock drives the frames; a headless browser runs ahead of them.
  const std::string play =
      "window.requestAnimationFrame = f => setTimeout(() => f(performance.now()), 16);"
      "press('Escape', ' '); await wait(1000); press(' ');";
  const std::string other =
      "document.getElementById('seed-on').click();"
      "document.querySelector('[data-layer=\"0:tree\"]').click();";
  const std::string nested = "scene=simple_passage&method=nested&seed=1";
  const std::string evil = "</script><script>document.title='caught'</script>";
  // A digest of the picture; the columns "checks" and "solved" of the first scene's rows after each click on a heading.
  const std::string digest =
      "const digest = () => { const c = document.getElementById('canvas');"
      "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
      "let sum = 0; for (let i = 0; i < d.length; i++) sum = (sum * 31 + d[i]) % 1000000007; return sum; };";
  const std::string sort = R"(
    const heading = [...document.querySelectorAll('#summary th')].find(th => th.textContent === 'checks');
    const order = () => {
      const all = [...document.querySelectorAll('#summary tbody tr')];
      const from = all.findIndex(row => row.textContent === 'simple_passage');
      const to = all.findIndex((row, i) => i > from && row.classList.contains('group'));
      const column = [...all[from + 1].cells].length - 4;
      return all.slice(from + 1, to).map(row => row.cells[column].textContent).join(',');
    };
    view.dataset.unsorted = order();
    for (const name of ['ascending', 'descending', 'again']) {
      heading.querySelector('button').click();
      view.dataset[name] = order() + ' ' + heading.getAttribute('aria-sort');
    })";
  std::vector<Step> steps = {
      {"no address", ""},
      {"whole hierarchy", nested},
      {"early", nested + "&at=3"},
      {"of the root", nested + "&select=0:expansion:0"},
      {"of a guide", nested + "&at=0&select=2:tree:5"},
      {"unsolved", "scene=cup&method=hopeless&seed=1"},
      {"evil", "method=%3C/script%3E%3Cscript%3Edocument.title%3D%27caught%27%3C/script%3E"},
      {"nowhere", "scene=nowhere&method=none&seed=77&at=x&select=9:tree:1"},
      {"click", "scene=simple_passage&method=rrt&seed=1&at=5&layers=0:tree", click},
      {"keys", "method=rrt&at=7&select=0:expansion:2", "press('ArrowRight', 'ArrowRight', 'ArrowLeft', ']');"},
      {"play", "method=rrt&at=1&select=0:expansion:0", play},
      {"buttons", "method=mixed", other},
      {"density", nested, digest + "view.dataset.picture = digest();"},
      {"samples", nested + "&show=samples", digest + "view.dataset.picture = digest();"},
      {"half of the path", nested + "&along=500", digest + "view.dataset.picture = digest();"},
      {"drive", nested,
       "window.requestAnimationFrame = f => setTimeout(() => f(performance.now()), 16);"
       "press('d'); await wait(1000); press('d');"},
      {"sort", nested, sort},
      {"beside", nested + "&beside=rrt",
       "view.dataset.shownBeside = !document.getElementById('plot-beside').hidden;"
       "view.dataset.caption = document.getElementById('caption-beside').textContent;"
       "view.dataset.steps = document.getElementById('at').max;"
       "view.dataset.widths = [canvasWidth('canvas'), canvasWidth('canvas-beside')].join(',');"},
      {"figures", nested,
       "document.getElementById('fold-costs').open = true; await wait(50);"
       "view.dataset.compared = document.querySelectorAll('#compared figure > svg').length;"
       "view.dataset.dots = document.querySelectorAll('#compared circle').length;"
       "view.dataset.wide = Math.max(...[...document.querySelectorAll('#compared svg')].map(e => "
       "e.getBoundingClientRect().right)) <= document.documentElement.clientWidth;"
       "view.dataset.comparison = !document.getElementById('fold-costs').hidden;"
       "view.dataset.warnings = document.querySelector('#answer .notes').textContent;"
       "view.dataset.verdict = [...document.querySelectorAll('#worth th')].some(th => th.textContent === 'verdict');"},
      {"alone", nested, "view.dataset.shownBeside = !document.getElementById('plot-beside').hidden;"},
  };
  for (const auto* index : {"0", "1", "2", "3"}) {
    steps.push_back({std::string("mixed ") + index, std::string("method=mixed&select=0:expansion:") + index});
  }
  const std::vector<std::size_t> indices = {3, 17, 39};
  for (const std::size_t index : indices) {
    const std::string number = std::to_string(index);
    steps.push_back({"tree " + number, "scene=cup&method=rrt&seed=2&at=40&select=0:expansion:" + number});
  }
  const auto shown = perform(place, steps);

  // The first run, at its end.
  CHECK(shown.at("no address")["scene"] == "simple_passage");
  const std::string best = shown.at("no address")["method"];
  CHECK((best == "nested" || best == "mixed"));  // the best one with a guide
  CHECK(shown.at("no address")["seed"] == "1");
  // The page opens with a run that found a path.
  CHECK(shown.at("no address")["at"] == shown.at("no address")["total"]);
  CHECK(shown.at("no address")["outcome"].starts_with("solved"));
  CHECK(shown.at("nowhere")["scene"] == "simple_passage");
  CHECK(shown.at("nowhere")["select"].empty());

  // A plain tree, sample by sample.
  const auto tree = samples(place / "samples/cup/rrt/seed-2/samples.csv", "0", "tree");
  const auto proposals = samples(place / "samples/cup/rrt/seed-2/samples.csv", "0", "expansion");
  REQUIRE(proposals.size() > 40);
  std::size_t added = 0;
  for (std::size_t i = 0; i < 40; ++i) added += proposals[i].accepted ? 1 : 0;
  for (const std::size_t index : indices) {
    CAPTURE(index);
    const Shown& at = shown.at("tree " + std::to_string(index));
    CHECK(at["at"] == "40");
    CHECK(counts(at["proposals"]) == std::vector<std::size_t>{40});
    CHECK(counts(at["nodes"]) == std::vector<std::size_t>{added + 1});
    CHECK((at["fate"] != "rejected") == proposals[index].accepted);
    CHECK((at["source"] == "goal" || at["source"] == "uniform"));
    CHECK(at.said("became of it").starts_with(at["fate"]));
    REQUIRE(!at.said("y").empty());
    CHECK(std::abs(std::stod(at.said("y")) - proposals[index].q[1]) < 1e-3);
    CHECK(std::stoul(at["near"]) < tree.size());
  }

  // The levels of a hierarchy take turns, and reach the recorded state.
  const Json run = run_of("simple_passage", "nested", 1);
  const auto nodes = counts(shown.at("whole hierarchy")["nodes"]);
  const auto drawn = counts(shown.at("whole hierarchy")["proposals"]);
  REQUIRE(nodes.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(nodes[i] == run["levels"][i]["nodes"]);
    CHECK(drawn[i] == run["levels"][i]["proposals"]);
  }
  // The trees have their roots, which take no step; the skeleton comes first.
  CHECK(counts(shown.at("early")["nodes"]) == std::vector<std::size_t>{1, 1, 1, 3});
  CHECK(shown.at("of the root")["sampleLevel"] == "root");
  const Shown& guide = shown.at("of a guide");
  CHECK(guide["sampleLevel"] == "shrink(0.5)");
  CHECK(std::stoul(guide["at"]) > 0);  // the replay continues to the selection
  CHECK(counts(guide["nodes"])[0] == 1);

  // A mixture says which part drew.
  std::map<std::string, std::size_t> times;
  for (const auto* index : {"0", "1", "2", "3"}) {
    const Shown& at = shown.at(std::string("mixed ") + index);
    ++times[at["source"]];
    if (at["source"] == "skeleton()") CHECK(at.said("h that drew it") == "skeleton() (level 1)");
  }
  const Json sources = run_of("simple_passage", "mixed", 1)["levels"][0]["sources"];
  for (const auto& source : sources) CHECK(times[source["name"]] <= source["proposals"]);
  CHECK(times.size() <= sources.size());

  CHECK(shown.at("unsolved")["outcome"].starts_with("not solved: "));
  CHECK(shown.at("unsolved")["total"] == "20");

  // A name that is markup stays text.
  CHECK(shown.at("evil")["method"] == evil);
  CHECK(shown.at("evil").title == "Trellis: script.lua");

  CHECK(shown.at("click")["select"] == "0:tree:0");
  CHECK(shown.at("click").said("x") == "1.000");
  CHECK(shown.at("click").tip == "root · node 0");
  CHECK(shown.at("keys")["at"] == "8");
  CHECK(shown.at("keys")["select"] == "0:expansion:3");
  CHECK(shown.at("play")["select"].empty());
  CHECK(std::stoul(shown.at("play")["at"]) > 1);
  CHECK(shown.at("buttons")["seed"] == "2");
  CHECK(shown.at("buttons")["layers"] == "0:expansion,0:path,1:path,1:tree");

  // Proposals are a density unless they are asked for one by one, and the robot moves along its path.
  CHECK(shown.at("density")["show"] == "density");
  CHECK(shown.at("density")["along"].empty());
  CHECK(shown.at("samples")["show"] == "samples");
  CHECK(shown.at("samples")["picture"] != shown.at("density")["picture"]);
  CHECK(shown.at("half of the path")["along"] == "500");
  CHECK(shown.at("half of the path")["picture"] != shown.at("density")["picture"]);
  REQUIRE_FALSE(shown.at("drive")["along"].empty());
  CHECK(std::stoul(shown.at("drive")["along"]) > 50);
  CHECK(std::stoul(shown.at("drive")["along"]) < 1000);

  // Columns sort within a scene, and come back.
  const Shown& sorted = shown.at("sort");
  const auto numbers = [](const std::string& text) {
    std::vector<double> out;
    std::istringstream parts(text.substr(0, text.find(' ')));
    for (std::string part; std::getline(parts, part, ',');) out.push_back(std::stod(part));
    return out;
  };
  const auto ascending = numbers(sorted["ascending"]);
  const auto descending = numbers(sorted["descending"]);
  REQUIRE(ascending.size() == 5);
  CHECK(std::is_sorted(ascending.begin(), ascending.end()));
  CHECK(std::is_sorted(descending.rbegin(), descending.rend()));
  CHECK(sorted["ascending"].ends_with(" ascending"));
  CHECK(sorted["descending"].ends_with(" descending"));
  CHECK(sorted["again"] == sorted["unsorted"] + " null");
  CHECK(numbers(sorted["unsorted"]) != ascending);

  // Another method's run on the same scene and seed stands beside; the replay takes as long as the longer one.
  const Shown& beside = shown.at("beside");
  CHECK(beside["beside"] == "rrt");
  CHECK(beside["shownBeside"] == "true");
  CHECK(shown.at("alone")["shownBeside"] == "false");
  CHECK(beside["caption"].starts_with("rrt: solved"));
  const std::size_t plain = run_of("simple_passage", "rrt", 1)["levels"][0]["proposals"];
  CHECK(std::stoul(beside["steps"]) == std::max(plain, std::stoul(beside["total"])));
  const auto widths = counts(beside["widths"]);
  CHECK(widths[0] > 100);
  CHECK(widths[0] == widths[1]);

  // Figures that compare the methods, those of this one, and what the printed report says.
  const Shown& figures = shown.at("figures");
  CHECK(figures["comparison"] == "true");
  CHECK(figures["compared"] == "2");  // every run, success
  CHECK(std::stoul(figures["dots"]) > 3);
  CHECK(figures["wide"] == "true");
  CHECK(figures["warnings"].find("hopeless: 4 unsolved") != std::string::npos);
  CHECK(figures["verdict"] == "true");

  const char* folder = std::getenv("TRELLIS_SCREENSHOTS");
  for (const std::string size : {"1400,900", "420,900"}) {
    const std::string file =
        folder != nullptr ? (fs::path(folder) / ("page-" + size + ".png")).string() : place / ("page-" + size + ".png");
    browse(place, "report.html#" + nested + "&beside=rrt&along=400",
           "--window-size=" + size + " --screenshot='" + file + "'");
    CHECK(content(file).starts_with("\x89PNG\r\n\x1a\n"));
    CHECK(fs::file_size(file) > 20000);
  }
}

TEST_CASE("control characters, quotes and markup in names are text on the page", "[browser][slow]") {
  if (!browser_is_here()) return;
  const Place place;
  place.script("script.lua", R"(
local name = [[</script><img src=x onerror="document.title = 'taken'"><b>'"&amp;]] .. '\27[2J\0\7'
return experiment {
  problems = problem {
    name = 'p' .. name, robot = robot.disc(0.48), start = {1, 1}, goal = {9, 9},
    world = world { bounds = {0, 0, 10, 10}, disc {5, 5, 1, name = 'o' .. name} },
  },
  strategies = { { 's' .. name, skeleton() >> rrt { step = 0.5 } }, { 't' .. name, rrt { step = 0.5 } } },
  measure = false,
}
)");
  const auto outcome = place.run({"run", "script.lua", "--quiet", "--html", "report.html"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  const std::string looked = R"(
        view.dataset.images = document.querySelectorAll('img[onerror]').length;
        const cells = [...document.querySelectorAll('td, th, button, option, h2, h3')];
        view.dataset.named = cells.some(cell => cell.textContent.includes('</' + 'script><img src=x'));)";
  const auto shown = perform(place, {{"looked", "", looked}});
  const Shown& page = shown.at("looked");
  CHECK(page["images"] == "0");
  CHECK(page["named"] == "true");
  CHECK(page.title.find("taken") == std::string::npos);
}

TEST_CASE("the page of a world of discs can be drawn while it has no width", "[browser][slow]") {
  if (!browser_is_here()) return;
  const Place place;
  place.script("script.lua", R"(
return experiment {
  problems = problem {
    world = world { bounds = {0, 0, 10, 10}, disc {5, 5, 1} }, robot = robot.disc(0.48), start = {1, 1}, goal = {9, 9},
  },
  strategies = { { "nested", skeleton() >> rrt { step = 0.5 } } },
  measure = false,
}
)");
  const auto outcome = place.run({"run", "script.lua", "--quiet", "--html", "report.html"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  const std::string measured = R"(
        window.dispatchEvent(new Event('resize'));
        await wait(60);
        view.dataset.width = document.getElementById('plot').clientWidth;)";
  const auto shown =
      perform(place, {{"without width", "", "document.getElementById('plot').style.width = '0';" + measured},
                      {"with width", "", "document.getElementById('plot').style.width = '';" + measured}});
  CHECK(shown.at("without width")["width"] == "0");
  CHECK(std::stoi(shown.at("with width")["width"]) > 100);
}

TEST_CASE("the page of a problem in space turns its view, and shows samples, robots and what obstacles hide",
          "[browser][slow]") {
  if (!browser_is_here()) return;
  const Place place;
  place.script("script.lua", R"(
local blocks = world { bounds = {0, 0, 0, 10, 10, 10}, box {4, 0, 0, 6, 10, 4.6}, box {4, 0, 5.4, 6, 10, 10},
                       sphere {2.5, 5, 5, 0.6}, box {0, 0, 10, 10, 10, 10.2, name = "ceiling"} }
local slot = problem {
  name = "slot", world = blocks, robot = robot.rigid { box {-0.8, -0.5, -0.1, 0.8, 0.5, 0.1} },
  start = pose {1, 5, 5, axis = {0, 1, 0}, angle = math.pi / 2}, goal = pose {9, 5, 5, axis = {1, 0, 0}, angle = math.pi / 2} }
local planner = rrt_connect { step = 1 }
return experiment { problems = {slot}, strategies = { rrt_connect = planner, nested = workspace() >> shrink(0.5) >> planner },
                    seeds = 1 }
)");
  const auto outcome = place.run({"run", "script.lua", "--quiet", "--html", "report.html", "--samples", "samples"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  CHECK(fs::file_size(place / "report.html") < 5'000'000);

  const std::string look = R"(
    const canvas = document.getElementById('canvas'), solids = canvas.solids.picture, data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    let sum = 0; for (let i = 0; i < data.length; i++) sum = (sum * 31 + data[i]) % 1000000007;
    view.dataset.picture = sum;
    view.dataset.covered = solids.depths.filter(d => d > -Infinity).length / solids.depths.length;)";
  const auto drag = [](const std::string& more) {
    return R"(
    const hand = document.getElementById('canvas'), box = hand.getBoundingClientRect();
    const at = (x, y) => ({clientX: box.left + x, clientY: box.top + y, bubbles: true, buttons: 1, pointerId: 1)" +
           more + R"(});
    hand.dispatchEvent(new PointerEvent('pointerdown', at(200, 200)));
    hand.dispatchEvent(new PointerEvent('pointermove', at(300, 250)));
    hand.dispatchEvent(new PointerEvent('pointerup', at(300, 250)));)";
  };
  const std::string nested = "scene=slot&method=nested&seed=1";
  const auto shown =
      perform(place, {{"first", nested, look},
                      {"again", nested, look},
                      {"keys", nested, "press('j', 'j', 'k');" + look},
                      {"restored", nested, "press('0');" + look},
                      {"dragged", nested, drag("") + look},
                      {"moved", nested, "press('0');" + drag(", shiftKey: true") + look},
                      {"address", nested + "&view=90,90", look},
                      {"driven", nested + "&along=500&layers=0:path", look},
                      {"farther", nested + "&along=600&layers=0:path", look},
                      {"selected", "scene=slot&method=rrt_connect&seed=1&select=0:tree:3&layers=0:tree", look},
                      {"beside", nested + "&beside=rrt_connect",
                       "view.dataset.covered = document.getElementById('canvas-beside').solids.picture.depths.length;"},
                      {"samples", nested + "&show=samples&layers=0:expansion,1:tree,2:tree", look}});
  const auto picture = [&](const char* name) { return shown.at(name)["picture"]; };
  CHECK(picture("first") == picture("again"));
  CHECK(picture("first") != picture("keys"));
  CHECK(shown.at("keys")["view"] == "-80,20");
  CHECK(picture("restored") == picture("first"));
  CHECK(shown.at("restored")["view"].empty());
  CHECK(shown.at("dragged")["view"] == "-100,50");
  CHECK(picture("moved") != picture("first"));
  CHECK(shown.at("moved")["view"].empty());
  CHECK(picture("address") != picture("first"));
  CHECK(picture("driven") != picture("farther"));
  CHECK(shown.at("driven")["along"] == "500");
  // The blocks are drawn, and the ceiling does not close the view from above: it would cover five times as much.
  CHECK(std::stod(shown.at("first")["covered"]) > 0.03);
  CHECK(std::stod(shown.at("address")["covered"]) > 0.01);
  CHECK(std::stod(shown.at("address")["covered"]) < 0.06);
  CHECK(std::stod(shown.at("beside")["covered"]) > 0.0);

  const Shown& selected = shown.at("selected");
  CHECK(selected["select"] == "0:tree:3");
  const auto tree = samples(place / "samples/slot/rrt_connect/seed-1/samples.csv", "0", "tree");
  REQUIRE(tree.size() > 3);
  REQUIRE(tree[3].q.size() == 7);
  for (const auto& [axis, value] : {std::pair{"x", 0}, std::pair{"y", 1}, std::pair{"z", 2}}) {
    std::string said = selected.said(axis);
    CHECK(std::stod(said) == Approx(tree[3].q[static_cast<std::size_t>(value)]).margin(0.002));
  }
  const double angle = 2.0 * std::acos(std::min(1.0, std::abs(tree[3].q[6]))) * 180.0 / 3.14159265358979;
  CHECK(std::stod(selected.said("rotation")) == Approx(angle).margin(0.6));
  CHECK_THAT(selected.said("rotation"), Catch::Matchers::Contains("° about ("));
  if (const char* screenshots = std::getenv("TRELLIS_SCREENSHOTS")) {
    browse(place, "report.html#" + nested,
           "--window-size=1400,1900 --screenshot='" + std::string(screenshots) + "/space.png'");
  }
}

TEST_CASE("the page moves all robots of a team, each in its colour", "[browser][slow]") {
  if (!browser_is_here()) return;
  const Place place;
  place.script("script.lua", R"(
return experiment {
  problems = { problem { name = "team", world = world { bounds = {0, 0, 10, 10} },
                         robot = robots { robot.disc(1), robot.disc(1), robot.rectangle(2, 1) },
                         start = { {2, 2}, {8, 2}, {2, 8, 0} }, goal = { {2, 5}, {8, 8}, {5, 8, 0} } } },
  strategies = { { "one by one", prioritise() >> rrt_connect {} } },
  seeds = 1,
  measure = false,
}
)");
  const auto outcome = place.run({"run", "script.lua", "--quiet", "--html", "report.html"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  // Whether a place of the world, which is 10 x 10, has a colour that is nearer to one of a robot than to the others.
  const std::string look = R"(
    const canvas = document.getElementById('canvas'), box = canvas.getBoundingClientRect(), ratio = canvas.width / box.width;
    const scale = Math.min(box.width - 16, box.height - 16) / 10;
    const robots = [[0, 114, 178], [213, 94, 0], [0, 158, 115]];
    const at = (x, y) => {
      const c = [box.width / 2 + (x - 5) * scale, box.height / 2 - (y - 5) * scale].map(v => Math.round(v * ratio));
      const d = canvas.getContext('2d').getImageData(c[0], c[1], 1, 1).data;
      if (d[0] > 225 && d[1] > 225 && d[2] > 225) return '-';
      const far = robots.map(r => Math.hypot(r[0] - d[0], r[1] - d[1], r[2] - d[2]));
      return String(far.indexOf(Math.min(...far)) + 1);
    };
    // Beside the number and the path of each robot.
    view.dataset.starts = at(1.5, 1.5) + at(8.5, 1.5) + at(1.4, 7.7);
    view.dataset.goals = at(1.5, 4.6) + at(8.5, 8.4) + at(5.6, 7.7);)";
  const std::string hover = look + R"(
    const middle = {clientX: box.left + box.width / 2 + 3 * scale, clientY: box.top + box.height / 2 + 3 * scale, bubbles: true};
    canvas.dispatchEvent(new PointerEvent('pointermove', middle));)";
  const std::string schedule = R"(
    view.dataset.schedule = [...document.querySelectorAll('#schedule text')].map(t => t.textContent).join('|');
    const square = {member: 0, points: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], radius: 0};
    const beside = (...at) => teams.gap([square, {member: 1, points: [at], radius: 1}, {member: 1, points: [at], radius: 0}]);
    view.dataset.gaps = [beside(4, 5, 0), beside(0.5, 0.5, 3), beside(0.5, 0.5, 0)].join(' ');)";
  auto shown = perform(place, {{"start", "layers=0:path", look},
                               {"schedule", "", schedule},
                               {"end", "layers=0:path&along=1000", look},
                               {"half", "layers=0:path&along=500", look},
                               {"over the second", "layers=0:tree", hover},
                               {"of one robot", "select=2:tree:0"}});
  for (const char* words : {"robot 1|", "robot 3|", "|smallest|gap|", "time, s"}) {
    CHECK_THAT(shown["schedule"]["schedule"], Catch::Matchers::Contains(words));
  }
  CHECK(shown["schedule"]["gaps"] == "4 2 0");
  CHECK(shown["start"]["starts"] == "123");
  CHECK(shown["start"]["goals"] == "---");
  CHECK(shown["end"]["goals"] == "123");
  CHECK(shown["half"]["along"] == "500");
  CHECK(shown["half"]["starts"] != "123");
  CHECK_THAT(shown["over the second"].tip, Catch::Matchers::Contains("root"));
  CHECK(shown["of one robot"]["sampleLevel"] == "robot 1");
}
