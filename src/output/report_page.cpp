#include "pellicle/output/report_page.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "pellicle/base/errors.h"
#include "pellicle/output/page_assets.h"
#include "pellicle/output/page_case.h"
#include "pellicle/output/provenance.h"

namespace pellicle {
namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

namespace {

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

std::string page_of(const std::vector<PageCase>& cases, const PageSettings& settings, const Observer& observer) {
  const PageLimits limits = limits_for(cases.size(), settings);
  const ScratchFolder scratch;
  json data = {{"cases", json::array()}};
  std::string files;
  bool any_file = false;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    observer.check_stopped();
    observer.tell_progress(static_cast<double>(i) / static_cast<double>(cases.size()), cases[i].name);
    PageParts parts = page_parts(cases[i], limits, settings.viewer, scratch.path());
    any_file = any_file || !parts.mesh.empty();
    data["cases"].push_back(with_files(std::move(parts), i, files));
  }
  observer.tell_progress(1.0, "done");
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
