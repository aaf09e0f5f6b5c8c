#include "pellicle/batch/batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <list>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/child_process.h"
#include "pellicle/base/errors.h"
#include "pellicle/output/outputs.h"
#include "pellicle/settings/settings.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// FNV-1a, 64 bits: tells changed arguments, guards against nothing.
std::string fingerprint(const std::vector<std::string>& arguments) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto add = [&](unsigned char byte) { hash = (hash ^ byte) * 0x100000001b3ULL; };
  for (const auto& argument : arguments) {
    for (const char c : argument) add(static_cast<unsigned char>(c));
    add(0);
  }
  return fmt::format("{:016x}", hash);
}

// What a killed run may have left (AtomicFile) of files whose names begin with `stem`; empty: of any.
void remove_parts(const fs::path& folder, const std::string& stem = "") {
  std::error_code fault;
  std::vector<fs::path> parts;
  for (fs::directory_iterator at(folder, fault), end; !fault && at != end; at.increment(fault)) {
    const std::string name = at->path().filename().string();
    const bool ours = name.starts_with('.') && (stem.empty() || name.starts_with(fmt::format(".{}.", stem)));
    if (ours && name.find(".part") != std::string::npos) parts.push_back(at->path());
  }
  for (const auto& part : parts) fs::remove(part, fault);
}

class Batch {
 public:
  Batch(std::vector<BatchCase> cases, const BatchSettings& settings, const BatchContext& context)
      : cases_(std::move(cases)), settings_(settings), context_(context) {
    result_.table = settings.output / (settings.table.empty() ? table_name(settings.shard) : settings.table);
    const int threads = settings.threads > 0 ? settings.threads : static_cast<int>(std::thread::hardware_concurrency());
    threads_each_ = std::max(1, threads / settings.jobs);
    arguments_.reserve(cases_.size());
    result_.rows.reserve(cases_.size());
    for (const auto& one : cases_) {
      arguments_.push_back(arguments_of(one, settings.common));
      BatchRow row;
      row.name = one.name;
      row.arguments = fingerprint(arguments_.back());
      result_.rows.push_back(row);
    }
  }

  BatchResult run() {
    prepare();
    try {
      while (step()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    } catch (const Interrupted&) {
      stop_children();
      write_table();
      throw;
    }
    write_table();
    return std::move(result_);
  }

 private:
  struct Running {
    std::size_t index;
    Clock::time_point start;
    ChildProcess child;
  };

  void prepare() {
    std::error_code ignored;
    if (!settings_.resume && !settings_.overwrite && fs::exists(result_.table, ignored)) {
      throw CannotCreate(
          fmt::format("output exists ({}): give `resume` to go on, `overwrite` to start anew, or another folder",
                      result_.table.string()));
    }
    check_outputs({result_.table}, true, {});
    create_folder(settings_.output);
    if (settings_.resume) keep_finished();
    write_table();
  }

  // The report lists the other files; a case that was told to write none has to have any file at all.
  bool files_are_there(const std::string& name) const {
    std::error_code fault;
    const fs::path folder = settings_.output / name, report = folder / (name + "_report.json");
    if (fs::exists(folder / (name + "_series.png"), fault)) return true;  // the last file of a time series
    if (!fs::exists(report, fault))
      return !writes_report(name) && fs::is_directory(folder, fault) && !fs::is_empty(folder, fault);
    std::ifstream in(report);
    const auto content = nlohmann::json::parse(in, nullptr, false);
    if (!content.is_object() || !content.contains("outputs")) return false;
    for (const auto& file : content["outputs"]) {
      if (!file.is_object()) return false;
      if (file.value("kind", "") == "trace") continue;  // in a folder of its own
      if (!fs::exists(folder / fs::path(file.value("path", "")).filename(), fault)) return false;
    }
    return true;
  }

  bool writes_report(const std::string& name) const {
    const auto& one = *std::find_if(cases_.begin(), cases_.end(), [&](const BatchCase& c) { return c.name == name; });
    for (const FlagValues* values : {&one.values, &settings_.common}) {
      const auto wanted = values->find("write");
      if (wanted == values->end()) continue;
      const auto kinds = split_commas(wanted->second.front());
      return std::find(kinds.begin(), kinds.end(), "report") != kinds.end();
    }
    return true;
  }

  void keep_finished() {
    std::map<std::string, BatchRow> known;
    for (auto& row : read_batch_tables(settings_.output)) {
      // A later table may know more than the one of the whole batch.
      BatchRow& place = known[row.name];
      if (!place.done() || row.done()) place = row;
    }
    // Other shards may be writing their tables into this folder now.
    const std::string table = result_.table.filename().string();
    remove_parts(settings_.output, table.substr(0, table.find('.')));
    for (auto& row : result_.rows) {
      const auto found = known.find(row.name);
      if (found == known.end() || !found->second.done() || found->second.arguments != row.arguments) continue;
      if (!files_are_there(row.name)) continue;
      row = found->second;
      ++result_.kept;
    }
  }

  // One round: collect who has ended, start who may. False when there is nothing more to wait for.
  bool step() {
    context_.observer.check_stopped();
    for (auto at = running_.begin(); at != running_.end();) {
      if (auto ended = at->child.poll()) {
        finish(at->index, seconds_since(at->start), *ended);
        at = running_.erase(at);
      } else {
        ++at;
      }
    }
    while (!stopping_ && next_ < cases_.size() && running_.size() < static_cast<std::size_t>(settings_.jobs)) {
      if (!result_.rows[next_].done()) start(next_);
      ++next_;
    }
    tell();
    return !running_.empty();
  }

  void start(std::size_t index) {
    const std::string& name = cases_[index].name;
    const fs::path folder = settings_.output / name;
    if (settings_.resume) remove_parts(folder);
    std::vector<std::string> words{"segment"};
    words.insert(words.end(), arguments_[index].begin(), arguments_[index].end());
    words.push_back(fmt::format("--output={}", folder.string()));
    words.push_back(fmt::format("--name={}", name));
    words.push_back(fmt::format("--threads={}", threads_each_));
    words.emplace_back("--no-progress");
    // Files of a case that did not end are half of something: they may go.
    if (settings_.overwrite || settings_.resume) words.emplace_back("--overwrite");
    running_.push_back({index, Clock::now(), ChildProcess(settings_.program, words)});
  }

  void finish(std::size_t index, double seconds, const ChildExit& ended) {
    BatchRow& row = result_.rows[index];
    fill_row(row, ended.out, ended.err, ended.exit_code, ended.signal);
    row.seconds = seconds;
    row.peak_memory_mb = static_cast<double>(ended.peak_memory_bytes) / 1e6;
    write_log(row.name, ended.err);
    if (row.failed() && !settings_.keep_going) stopping_ = true;
    // A table of many thousand rows is not written for each of them.
    if (result_.rows.size() < 500 || seconds_since(last_write_) > 1.0) write_table();
    if (context_.finished) context_.finished(row);
  }

  void write_log(const std::string& name, const std::string& err) const {
    const fs::path folder = settings_.output / name, log = folder / (name + "_log.txt");
    std::error_code ignored;
    if (err.empty()) {
      fs::remove(log, ignored);
      return;
    }
    fs::create_directories(folder, ignored);
    if (fs::is_directory(folder, ignored)) write_text_file(log, err);
  }

  void write_table() {
    write_text_file(result_.table, table_of(result_.rows));
    last_write_ = Clock::now();
  }

  void stop_children() {
    for (const auto& one : running_) one.child.ask_to_stop();
    const auto asked = Clock::now();
    while (!running_.empty() && seconds_since(asked) < 10.0) {
      std::erase_if(running_, [](Running& one) { return one.child.poll().has_value(); });
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    running_.clear();  // who does not listen is ended
  }

  void tell() const {
    if (cases_.empty()) return;
    const auto ended = static_cast<std::size_t>(std::count_if(
        result_.rows.begin(), result_.rows.end(), [](const BatchRow& row) { return row.exit_code.has_value(); }));
    context_.observer.tell_progress(static_cast<double>(ended) / static_cast<double>(cases_.size()),
                                    fmt::format("{} of {} cases", ended, cases_.size()));
  }

  std::vector<BatchCase> cases_;
  const BatchSettings& settings_;
  const BatchContext& context_;
  std::vector<std::vector<std::string>> arguments_;
  BatchResult result_;
  std::list<Running> running_;
  std::size_t next_ = 0;
  int threads_each_ = 1;
  bool stopping_ = false;
  Clock::time_point last_write_{};
};

}  // namespace

void BatchSettings::validate() const {
  if (output.empty()) throw SettingError("missing setting", "output", "no output folder; give `output` DIR");
  if (jobs < 1) throw SettingError("bad value", "jobs", std::to_string(jobs), "must be 1 or more");
  if (threads < 0)
    throw SettingError("bad value", "threads", std::to_string(threads), "must be 1 or more; 0 means all cores");
  if (resume && overwrite) {
    throw SettingError("conflicting settings", "resume, overwrite",
                       "one keeps what is there, the other replaces it; keep one");
  }
}

int BatchResult::exit_code() const {
  if (std::any_of(rows.begin(), rows.end(), [](const BatchRow& row) { return row.failed(); })) return 1;
  return std::all_of(rows.begin(), rows.end(), [](const BatchRow& row) { return row.status == "ok"; }) ? 0 : 3;
}

BatchResult run_batch(const std::vector<BatchCase>& cases, const BatchSettings& settings, const BatchContext& context) {
  settings.validate();
  return Batch(cases_of_shard(cases, settings.shard), settings, context).run();
}

}  // namespace pellicle
