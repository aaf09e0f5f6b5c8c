#include "pellicle/batch/page_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "pellicle/base/errors.h"
#include "pellicle/batch/batch_table.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view report_ending = "_report.json";

CaseOutcome outcome_of(const BatchRow& row) {
  return {.status = row.status, .message = row.message, .seconds = row.seconds, .done = row.done()};
}

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
      if (!known.outcome->done && row.exit_code) known.outcome = outcome_of(row);
      continue;
    }
    PageCase one{row.name, {}, outcome_of(row)};
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

}  // namespace pellicle
