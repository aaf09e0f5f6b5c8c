#include "pellicle/batch/batch_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>

#include "pellicle/base/errors.h"
#include "pellicle/settings/settings.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

constexpr const char* kHeader =
    "case\tstatus\texit_code\tseconds\tvolume_ml\tobjects\tpeak_memory_mb\targuments\tmessage";
constexpr std::size_t column_count = 9;
constexpr const char* none = "n/a";

template <class T>
std::string cell(const std::optional<T>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : none;
}

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
  while (text.ends_with(' ')) text.pop_back();
  return text.empty() ? none : text;
}

std::string text_of(const std::string& cell) {
  return cell == none ? "" : cell;
}

std::optional<double> number_in(const std::string& cell, const std::string& where) {
  if (cell == none) return std::nullopt;
  return number_of(cell, where);
}

std::optional<int> integer_in(const std::string& cell, const std::string& where) {
  if (cell == none) return std::nullopt;
  return integer_of(cell, where);
}

BatchRow row_of(const std::vector<std::string>& cells, const std::string& where) {
  BatchRow row;
  row.name = cells[0];
  row.status = cells[1];
  row.exit_code = integer_in(cells[2], where);
  row.seconds = number_in(cells[3], where);
  row.volume_ml = number_in(cells[4], where);
  row.objects = integer_in(cells[5], where);
  row.peak_memory_mb = number_in(cells[6], where);
  row.arguments = text_of(cells[7]);
  row.message = text_of(cells[8]);
  return row;
}

// The last line that is an error, without the program's name in front; else the last line.
std::string reason_in(const std::string& err) {
  constexpr std::string_view mark = "pellicle: error: ";
  std::istringstream in(err);
  std::string reason, last;
  for (std::string line; std::getline(in, line);) {
    if (line.empty()) continue;
    last = line;
    if (line.starts_with(mark)) reason = line.substr(mark.size());
  }
  return reason.empty() ? last : reason;
}

}  // namespace

std::string table_name(const Shard& shard) {
  return shard.count == 1 ? "batch.tsv" : fmt::format("batch-{}-of-{}.tsv", shard.index, shard.count);
}

std::string table_of(const std::vector<BatchRow>& rows) {
  std::string text = fmt::format("{}\n", kHeader);
  for (const auto& row : rows) {
    text += fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\n", row.name, row.status, cell(row.exit_code, "{}"),
                        cell(row.seconds, "{:.3f}"), cell(row.volume_ml, "{:.6g}"), cell(row.objects, "{}"),
                        cell(row.peak_memory_mb, "{:.1f}"), one_line(row.arguments), one_line(row.message));
  }
  return text;
}

std::vector<BatchRow> read_batch_table(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw IoError(fmt::format("cannot open ({}): the table of an earlier batch is not readable", path.string()));
  std::vector<BatchRow> rows;
  std::string line;
  const bool known = static_cast<bool>(std::getline(in, line)) && line == kHeader;
  for (std::size_t number = 2; known && std::getline(in, line); ++number) {
    std::vector<std::string> cells(1);
    for (const char c : line) {
      if (c == '\t') {
        cells.emplace_back();
      } else {
        cells.back() += c;
      }
    }
    const std::string where = fmt::format("{}:{}", path.string(), number);
    if (cells.size() != column_count)
      throw BadData(fmt::format("broken table ({}): {} cells, not {}", where, cells.size(), column_count));
    try {
      rows.push_back(row_of(cells, where));
    } catch (const UsageError& fault) {
      throw BadData(fault.what());
    }
  }
  if (!known) {
    throw BadData(
        fmt::format("not a table of a batch ({}): its first line has other columns; remove it or choose another folder",
                    path.string()));
  }
  return rows;
}

std::vector<BatchRow> read_batch_tables(const fs::path& folder) {
  std::vector<fs::path> tables;
  std::error_code fault;
  for (fs::directory_iterator at(folder, fault), end; !fault && at != end; at.increment(fault)) {
    const std::string name = at->path().filename().string();
    const bool part = name.starts_with("batch-") && name.ends_with(".tsv");
    if ((name == "batch.tsv" || part) && at->is_regular_file(fault)) tables.push_back(at->path());
  }
  std::sort(tables.begin(), tables.end(), [](const fs::path& a, const fs::path& b) {
    const bool a_whole = a.filename() == "batch.tsv", b_whole = b.filename() == "batch.tsv";
    return a_whole != b_whole ? a_whole : a < b;
  });
  std::vector<BatchRow> rows;
  for (const auto& table : tables) {
    const auto more = read_batch_table(table);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  return rows;
}

void fill_row(BatchRow& row, const std::string& out, const std::string& err, int exit_code, int signal) {
  row.exit_code = exit_code;
  if (!row.done()) {
    row.status = "failed";
    row.message = signal != 0 ? fmt::format("ended by signal {} ({})", signal, strsignal(signal)) : reason_in(err);
    return;
  }
  row.status = "ok";
  int objects = 0;
  double volume = 0.0;
  std::istringstream lines(out);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string label, volume_ml, status;
    if (!(words >> label >> volume_ml >> status)) continue;
    ++objects;
    volume += number_of(volume_ml, "volume of " + row.name);
    if (row.status == "ok") row.status = status;
  }
  row.objects = objects;
  row.volume_ml = volume;
}

}  // namespace pellicle
