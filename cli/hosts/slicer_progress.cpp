#include "hosts/slicer_progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace pellicle::cli {

namespace {

// Slicer takes what stands between the tags as it is, up to the next '<'.
std::string plain(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '<' || c == '>' || c == '&' || c == '\n'; }, ' ');
  return text;
}

void say(const std::string& line) {
  std::cout << line << std::endl;  // NOLINT(performance-avoid-endl): whoever reads along waits for it
}

}  // namespace

SlicerProgress::SlicerProgress(bool on) : on_(on) {
  if (on_) {
    say("<filter-start><filter-name>Pellicle</filter-name><filter-comment>segment</filter-comment></filter-start>");
  }
}

SlicerProgress::~SlicerProgress() {
  if (on_) say("<filter-end><filter-name>Pellicle</filter-name></filter-end>");
}

void SlicerProgress::tell(double fraction, const std::string& what) {
  if (!on_) return;
  const int hundredths = static_cast<int>(std::floor(100.0 * std::clamp(fraction, 0.0, 1.0)));
  if (hundredths == hundredths_ && what == what_) return;
  if (what != what_) say(fmt::format("<filter-comment>{}</filter-comment>", plain(what)));
  if (hundredths != hundredths_) say(fmt::format("<filter-progress>{:.2f}</filter-progress>", hundredths / 100.0));
  hundredths_ = hundredths;
  what_ = what;
}

std::vector<std::string> with_dashed_flags(const std::vector<std::string>& words) {
  std::vector<std::string> dashed = words;
  for (auto& word : dashed) {
    if (!word.starts_with("--")) continue;
    const auto end = std::min(word.find('='), word.size());
    std::replace(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(end), '_', '-');
  }
  return dashed;
}

}  // namespace pellicle::cli
