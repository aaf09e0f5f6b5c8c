#pragma once
/// The cases of a batch: a table with a column a flag of `pellicle segment` and a row a case, or files by pattern.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pellicle {

/// Values of flags by name ("seed-sphere"), as they would be typed; a flag that may be repeated has several.
using FlagValues = std::map<std::string, std::vector<std::string>>;

struct BatchCase {
  std::string name;   ///< unique; folder and stem of the case's files
  FlagValues values;  ///< "input" among them; never "name" or "output"
};

/// Whether a batch lets this flag of `segment` differ from case to case. Those that it does not are the batch's own:
/// output, threads, overwrite, dry-run and the flags of the logs.
bool may_vary(const std::string& flag);

/// Comma-separated (RFC 4180: cells in double quotes may hold commas and line breaks), or tab-separated when the name
/// ends in .tsv. The first row names the columns: flags without dashes, or `config`; `name` is the case's name and
/// defaults to the input's. An empty cell leaves the flag unset; several values of a flag that repeats are separated by
/// semicolons; rows that are empty or start with '#' are skipped. Relative paths start at the table's folder.
/// \throws NoInput; BadData for a broken table; UsageError for an unknown column, an impossible value or a doubled
/// name:
///         all name file, line and column.
std::vector<BatchCase> read_manifest(const std::filesystem::path& path);

/// One case a file (or DICOM folder), sorted by path within a pattern; its name is the file's without extensions.
/// \param patterns as of a shell: *, ?, [...]. \throws NoInput when one matches nothing; UsageError on doubled names.
std::vector<BatchCase> cases_of_patterns(const std::vector<std::string>& patterns);

/// Part `index` of `count`, from 1.
struct Shard {
  int index = 1, count = 1;
};
/// "2/8". \throws UsageError.
Shard parse_shard(const std::string& text);
/// Every count-th case: the parts are disjoint and together complete, whatever runs them and when.
std::vector<BatchCase> cases_of_shard(const std::vector<BatchCase>& cases, const Shard& shard);

/// What `pellicle segment` is told about one case, without -o, `name` and the batch's own flags. The case wins over
/// what is common to all; the weights of `energy` join; a case with a seed of its own hears nothing of the common
/// seeds.
std::vector<std::string> arguments_of(const BatchCase& one, const FlagValues& common);

}  // namespace pellicle
