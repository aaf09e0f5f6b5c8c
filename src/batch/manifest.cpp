#include "pellicle/batch/manifest.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>

#include "pellicle/base/errors.h"
#include "pellicle/settings/settings.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

struct Record {
  std::size_t line = 0;  ///< where it starts, from 1
  std::vector<std::string> cells;
};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

// RFC 4180, and forgiving about blanks around cells.
class TableReader {
 public:
  TableReader(std::string text, char separator, std::string origin)
      : text_(std::move(text)), origin_(std::move(origin)), separator_(separator) {}

  std::vector<Record> records() {
    std::vector<Record> all;
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // as spreadsheets write it
    while (at_ < text_.size()) {
      Record record = next();
      const bool empty =
          std::all_of(record.cells.begin(), record.cells.end(), [](const std::string& cell) { return cell.empty(); });
      if (!empty && !record.cells.front().starts_with('#')) all.push_back(std::move(record));
    }
    return all;
  }

 private:
  Record next() {
    Record record{line_, {}};
    for (bool more = true; more;) {
      record.cells.push_back(cell());
      more = at_ < text_.size() && text_[at_] == separator_;
      if (at_ < text_.size()) line_ += text_[at_++] == '\n' ? 1U : 0U;
    }
    return record;
  }

  std::string cell() {
    while (at_ < text_.size() && (text_[at_] == ' ' || (text_[at_] == '\t' && separator_ != '\t'))) ++at_;
    if (at_ < text_.size() && text_[at_] == '"') return quoted_cell();
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != separator_ && text_[at_] != '\n') ++at_;
    return trimmed(text_.substr(begin, at_ - begin));
  }

  std::string quoted_cell() {
    const std::size_t start_line = line_;
    std::string value;
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"') {
        if (at_ + 1 == text_.size() || text_[at_ + 1] != '"') break;
        ++at_;
      }
      line_ += text_[at_] == '\n' ? 1U : 0U;
      value += text_[at_];
    }
    if (at_ == text_.size()) {
      throw BadData(
          fmt::format("broken table ({}:{}): a quoted cell has no end; close it with '\"'", origin_, start_line));
    }
    ++at_;
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\r')) ++at_;
    if (at_ < text_.size() && text_[at_] != separator_ && text_[at_] != '\n') {
      throw BadData(
          fmt::format("broken table ({}:{}): text after a quoted cell; quote the cell as a whole", origin_, line_));
    }
    return value;
  }

  std::string text_, origin_;
  char separator_;
  std::size_t at_ = 0, line_ = 1;
};

const Setting<SegmentSettings>* row_named(const std::string& name) {
  for (const auto& row : segment_table()) {
    if (row.name == name) return &row;
  }
  return nullptr;
}

bool repeats(const SettingKey& key) {
  return key.kind == SettingKind::vectors || key.kind == SettingKind::table;
}

std::vector<std::string> split_semicolons(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ';');) {
    if (const std::string value = trimmed(part); !value.empty()) parts.push_back(value);
  }
  return parts;
}

void check_column(const std::string& column, std::size_t line, const std::string& origin) {
  if (column == "name" || column == "config" || (row_named(column) != nullptr && may_vary(column))) return;
  const std::string where = fmt::format("{}:{}, column '{}'", origin, line, column);
  if (!may_vary(column)) {
    throw UsageError(
        fmt::format("bad column ({}): this is the same for all cases; give `{}` to 'pellicle batch'", where, column));
  }
  throw UsageError(fmt::format(
      "unknown column ({}): columns are the flags of 'pellicle segment' without dashes, such as input or seed-sphere",
      where));
}

std::vector<std::string> checked_columns(const Record& header, const std::string& origin) {
  std::set<std::string> seen;
  for (const auto& column : header.cells) {
    check_column(column, header.line, origin);
    if (!seen.insert(column).second) {
      throw UsageError(fmt::format(
          "doubled column ({}:{}, column '{}'): it must stand once; several values of a flag go in one cell, "
          "separated by semicolons",
          origin, header.line, column));
    }
  }
  if (!seen.contains("input")) {
    throw UsageError(
        fmt::format("missing column ({}:{}): there is no column 'input'; name the volumes in it", origin, header.line));
  }
  return header.cells;
}

std::string from_folder(const std::string& value, const fs::path& folder) {
  return fs::path(value).is_absolute() ? value : (folder / value).lexically_normal().string();
}

// Inputs are sought from the table's folder, so that a table and its data can move together.
std::string resolved_path(const std::string& column, const std::string& value, const fs::path& folder) {
  static const std::set<std::string> inputs{"input", "seeds", "seed-mask", "seed-model", "points", "config", "trace"};
  if (inputs.contains(column)) return from_folder(value, folder);
  std::error_code ignored;
  if (column == "preset" && value.ends_with(".toml") && fs::exists(folder / value, ignored))
    return from_folder(value, folder);
  return value;
}

// Throws what the program itself would say later about this value.
void check_value(const Setting<SegmentSettings>& row, const std::vector<std::string>& values,
                 const std::string& where) {
  SegmentSettings scratch;
  const bool list = row.kind == SettingKind::words || row.kind == SettingKind::vector;
  try {
    row.set(scratch, list ? split_commas(values.front()) : values);
  } catch (const SettingError& fault) {
    throw fault.at(where);
  }
}

BatchCase case_of(const Record& record, const std::vector<std::string>& columns, const fs::path& path) {
  const std::string origin = path.string();
  if (record.cells.size() != columns.size()) {
    throw BadData(fmt::format(
        "broken table ({}:{}): {} cells, but {} columns; quote cells that hold a comma, such as \"1,2,3,4\"", origin,
        record.line, record.cells.size(), columns.size()));
  }
  BatchCase one;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::string& cell = record.cells[c];
    if (cell.empty()) continue;
    if (columns[c] == "name") {
      one.name = cell;
      continue;
    }
    const Setting<SegmentSettings>* row = row_named(columns[c]);
    std::vector<std::string> values =
        row != nullptr && repeats(*row) ? split_semicolons(cell) : std::vector<std::string>{cell};
    if (values.empty()) continue;
    if (row != nullptr) check_value(*row, values, fmt::format("{}:{}, column '{}'", origin, record.line, columns[c]));
    for (auto& value : values) value = resolved_path(columns[c], value, path.parent_path());
    one.values[columns[c]] = std::move(values);
  }
  if (!one.values.contains("input")) {
    throw UsageError(
        fmt::format("missing value ({}:{}, column 'input'): the case has no volume; name one", origin, record.line));
  }
  return one;
}

void name_case(BatchCase& one, const std::string& where) {
  if (one.name.empty()) {
    SegmentSettings settings;
    settings.input = one.values.at("input").front();
    one.name = stem_of(settings);
  }
  const bool bad_letter = std::any_of(one.name.begin(), one.name.end(),
                                      [](char c) { return c == '/' || static_cast<unsigned char>(c) < 32; });
  if (bad_letter || one.name.starts_with('.') || one.name.starts_with('-')) {
    throw UsageError(fmt::format(
        "bad case name ({}): '{}' must be a file name without folders, not starting with '.' or '-'", where, one.name));
  }
}

void refuse_double(std::map<std::string, std::string>& seen, const BatchCase& one, const std::string& where) {
  const auto [first, is_new] = seen.emplace(one.name, where);
  if (is_new) return;
  throw UsageError(
      fmt::format("doubled case name ({}): '{}' is also at {}; give each case a name of its own in a column 'name'",
                  where, one.name, first->second));
}

}  // namespace

bool may_vary(const std::string& flag) {
  static const std::set<std::string> own{"output",    "output-mask", "output-mesh", "threads",
                                         "overwrite", "dry-run",     "quiet",       "verbose",
                                         "log-json",  "no-progress", "progress-xml"};
  return !own.contains(flag);
}

std::vector<BatchCase> read_manifest(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::error_code ignored;
  if (!in || fs::is_directory(path, ignored)) {
    throw NoInput(fmt::format("no such file ({}): the table of cases cannot be opened; check the path", path.string()));
  }
  std::ostringstream text;
  text << in.rdbuf();
  const char separator = path.extension() == ".tsv" ? '\t' : ',';
  const std::vector<Record> records = TableReader(text.str(), separator, path.string()).records();
  if (records.empty())
    throw BadData(fmt::format("empty table ({}): a row of column names is needed, then a row a case", path.string()));
  if (records.size() == 1)
    throw BadData(fmt::format("empty table ({}): no row follows the names; add a row a case", path.string()));
  const std::vector<std::string> columns = checked_columns(records.front(), path.string());
  std::vector<BatchCase> cases;
  cases.reserve(records.size() - 1);
  std::map<std::string, std::string> seen;
  for (std::size_t r = 1; r < records.size(); ++r) {
    const std::string where = fmt::format("{}:{}", path.string(), records[r].line);
    cases.push_back(case_of(records[r], columns, path));
    name_case(cases.back(), where);
    refuse_double(seen, cases.back(), where);
  }
  return cases;
}

std::vector<BatchCase> cases_of_patterns(const std::vector<std::string>& patterns) {
  std::vector<BatchCase> cases;
  std::map<std::string, std::string> seen;
  for (const auto& pattern : patterns) {
    glob_t found{};
    const int fault = glob(pattern.c_str(), GLOB_TILDE, nullptr, &found);
    const std::unique_ptr<glob_t, decltype(&globfree)> owner(&found, &globfree);
    if (fault != 0) throw NoInput(fmt::format("no such file ({}): nothing matches; check the pattern", pattern));
    for (std::size_t i = 0; i < found.gl_pathc; ++i) {
      const std::string path = found.gl_pathv[i];
      BatchCase one{"", {{"input", {path}}}};
      name_case(one, path);
      refuse_double(seen, one, path);
      cases.push_back(std::move(one));
    }
  }
  return cases;
}

Shard parse_shard(const std::string& text) {
  const auto refuse = [&text](const std::string& why) { throw SettingError("bad value", "shard", text, why); };
  const auto slash = text.find('/');
  if (slash == std::string::npos) refuse("write it like 2/8, the second of eight parts");
  const auto index = integer_in(text.substr(0, slash)), count = integer_in(text.substr(slash + 1));
  if (!index || !count) refuse("both parts must be whole numbers; write it like 2/8");
  const Shard shard{*index, *count};
  if (shard.index < 1 || shard.index > shard.count) {
    refuse("the part must be 1 to the number of parts; write it like 2/8");
  }
  return shard;
}

std::vector<BatchCase> cases_of_shard(const std::vector<BatchCase>& cases, const Shard& shard) {
  std::vector<BatchCase> part;
  for (auto i = static_cast<std::size_t>(shard.index) - 1; i < cases.size(); i += static_cast<std::size_t>(shard.count))
    part.push_back(cases[i]);
  return part;
}

std::vector<std::string> arguments_of(const BatchCase& one, const FlagValues& common) {
  static const std::set<std::string> seeds{"seed-sphere", "seed-point", "seeds",
                                           "seed-mask",   "seed-model", "seed-auto"};
  const bool own_seed =
      std::any_of(one.values.begin(), one.values.end(), [](const auto& flag) { return seeds.contains(flag.first); });
  FlagValues merged = common;
  if (own_seed) std::erase_if(merged, [](const auto& flag) { return seeds.contains(flag.first); });
  for (const auto& [flag, values] : one.values) {
    if (flag == "energy") {
      merged[flag].insert(merged[flag].end(), values.begin(), values.end());  // the later weight of a name wins
    } else {
      merged[flag] = values;
    }
  }
  std::vector<std::string> arguments;
  for (const auto& [flag, values] : merged) {
    // As one word, so that a value may start with a dash.
    for (const auto& value : values) arguments.push_back(fmt::format("--{}={}", flag, value));
  }
  return arguments;
}

}  // namespace pellicle
