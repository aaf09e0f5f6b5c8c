#include "pellicle/pipeline/report_page.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include "pellicle/base/errors.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/pipeline/page_assets.h"
#include "pellicle/pipeline/page_case.h"
#include "pellicle/pipeline/provenance.h"

namespace pellicle {
namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

namespace {

constexpr std::string_view report_ending = "_report.json";

class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "pellicle-report-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw IoError(fmt::format("no temporary folder ({}): the page needs one", name));
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string name_of_report(const fs::path& path) {
  std::string name = path.filename().string();
  if (name.ends_with(report_ending)) name.resize(name.size() - report_ending.size());
  return name;
}

std::vector<PageCase> cases_of_batch(const fs::path& folder) {
  std::vector<PageCase> cases;
  std::map<std::string, std::size_t> places;
  for (auto& row : read_batch_tables(folder)) {
    const auto [place, is_new] = places.emplace(row.name, cases.size());
    if (!is_new) {
      PageCase& known = cases[place->second];
      if (!known.row->done() && row.exit_code) known.row = row;
      continue;
    }
    PageCase one{row.name, {}, row};
    const fs::path report = folder / row.name / (row.name + std::string(report_ending));
    std::error_code ignored;
    if (fs::exists(report, ignored)) one.report = report;
    cases.push_back(std::move(one));
  }
  return cases;
}

std::vector<PageCase> cases_of_folder(const fs::path& folder) {
  std::vector<PageCase> cases = cases_of_batch(folder);
  if (!cases.empty()) return cases;
  std::vector<fs::path> reports;
  std::error_code fault;
  for (fs::recursive_directory_iterator at(folder, fault), end; !fault && at != end; at.increment(fault)) {
    if (at->path().filename().string().ends_with(report_ending)) reports.push_back(at->path());
  }
  std::sort(reports.begin(), reports.end());
  for (const auto& report : reports) cases.push_back({name_of_report(report), report, {}});
  return cases;
}

PageLimits limits_for(std::size_t cases, const PageSettings& settings) {
  constexpr double most_voxels = 40e6, most_triangles = 3e6;  // of a whole page: some tens of megabytes
  const double count = static_cast<double>(std::max<std::size_t>(cases, 1));
  PageLimits limits;
  limits.edge = settings.edge.value_or(static_cast<int>(std::clamp(std::cbrt(most_voxels / count), 24.0, 128.0)));
  limits.most_triangles = static_cast<std::size_t>(std::clamp(most_triangles / count, 2000.0, 30000.0));
  return limits;
}

std::string html_text(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&') {
      safe += "&amp;";
    } else if (c == '<') {
      safe += "&lt;";
    } else if (c == '>') {
      safe += "&gt;";
    } else {
      safe += c;
    }
  }
  return safe;
}

// JSON inside a script element: nothing in it may look like a tag.
std::string script_text(const json& value) {
  const std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return safe;
}

std::string filled(std::string_view text, const std::map<std::string, std::string>& places) {
  std::string page;
  std::size_t at = 0;
  for (auto open = text.find("{{"); open != std::string_view::npos; open = text.find("{{", at)) {
    const auto close = text.find("}}", open);
    page += text.substr(at, open - at);
    page += places.at(std::string(text.substr(open + 2, close - open - 2)));
    at = close + 2;
  }
  page += text.substr(at);
  return page;
}

void add_file(const std::string& id, const std::string& bytes, std::string& files) {
  files += fmt::format("<script type=\"text/plain\" id=\"{}\">", id) + base64_of(bytes) + "</script>\n";
}

// The parts that the viewer loads on demand stand apart from the facts.
json with_files(PageParts parts, std::size_t index, std::string& files) {
  json& facts = parts.facts;
  json named = json::object();
  if (!parts.volume.empty()) {
    named["volume"] = fmt::format("volume-{}", index);
    add_file(named["volume"], parts.volume, files);
  }
  if (!parts.mesh.empty()) {
    named["mesh"] = fmt::format("mesh-{}", index);
    add_file(named["mesh"], parts.mesh, files);
  }
  named["note"] = facts.value("note", facts.value("volume_note", ""));
  facts["files"] = named;
  return facts;
}

}  // namespace

std::vector<PageCase> find_page_cases(const std::vector<fs::path>& sources) {
  std::vector<PageCase> cases;
  std::set<fs::path> seen;
  std::error_code ignored;
  for (const auto& source : sources) {
    if (!fs::exists(source, ignored))
      throw NoInput(fmt::format("no such file ({}): nothing is there; check the path", source.string()));
    const bool folder = fs::is_directory(source, ignored);
    const std::vector<PageCase> found =
        folder ? cases_of_folder(source) : std::vector<PageCase>{{name_of_report(source), source, {}}};
    if (found.empty()) {
      throw NoInput(
          fmt::format("no result ({}): neither a batch.tsv nor a *_report.json is in it; name the folder that "
                      "'pellicle segment' or "
                      "'pellicle batch' wrote to",
                      source.string()));
    }
    for (const auto& one : found) {
      if (one.report && !seen.insert(fs::weakly_canonical(*one.report, ignored)).second) continue;
      cases.push_back(one);
    }
  }
  return cases;
}

std::string page_of(const std::vector<PageCase>& cases, const PageSettings& settings, const Progress& progress) {
  const PageLimits limits = limits_for(cases.size(), settings);
  const ScratchFolder scratch;
  json data = {{"cases", json::array()}};
  std::string files;
  bool any_file = false;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    check_interrupt();
    if (progress) progress(static_cast<double>(i) / static_cast<double>(cases.size()), cases[i].name);
    PageParts parts = page_parts(cases[i], limits, settings.viewer, scratch.path());
    any_file = any_file || !parts.mesh.empty();
    data["cases"].push_back(with_files(std::move(parts), i, files));
  }
  if (progress) progress(1.0, "done");
  const std::string title = settings.title.empty()
                                ? (cases.size() == 1 ? cases.front().name : fmt::format("{} cases", cases.size()))
                                : settings.title;
  return filled(page_template(), {{"TITLE", html_text(title)},
                                  {"VERSION", program_version()},
                                  {"NIIVUE", PELLICLE_NIIVUE_VERSION},
                                  {"STYLE", std::string(page_style())},
                                  {"SCRIPT", std::string(page_script())},
                                  {"LICENCE", html_text(std::string(niivue_licence()))},
                                  {"DATA", script_text(data)},
                                  {"FILES", files},
                                  {"VIEWER", any_file ? base64_of(std::string(niivue_gzip())) : ""}});
}

}  // namespace pellicle
