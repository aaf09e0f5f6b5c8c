// The running of a batch, with a small script in the place of the program: it obeys the words in its input's name.
#include "pellicle/batch/batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <sstream>

#include "../temporary_folder.h"
#include "pellicle/base/errors.h"

namespace pellicle {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* script = R"(#!/bin/sh
for a; do case "$a" in --name=*) name=${a#*=};; --output=*) out=${a#*=};; --input=*) in=${a#*=};; esac; done
here=$(dirname "$0")
echo "$name" >> "$here/started"
case "$in" in
  *crash*) kill -SEGV $$ ;;
  *bad*) echo 'pellicle: warning: first' >&2; echo 'pellicle: error: no good (x): because' >&2; exit 65 ;;
  *slow*) if [ ! -e "$here/quick" ]; then sleep 20; fi ;;
esac
mkdir -p "$out"
echo "mask of $in" > "$out/${name}_mask"
echo "{\"outputs\": [{\"kind\": \"mask\", \"path\": \"$out/${name}_mask\"}]}" > "$out/${name}_report.json"
case "$in" in *weak*) echo '1 2.5 ok 0.1'; echo '2 1.5 ambiguous 0.1'; exit 3 ;; esac
echo '1 2.5 ok 0.1'
)";

std::string text_in(const fs::path& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class BatchRun : public testing::Test {
 protected:
  BatchRun() {
    std::ofstream(folder_ / "program") << script;
    chmod((folder_ / "program").c_str(), 0755);
    settings_.program = folder_ / "program";
    settings_.output = folder_ / "out";
    settings_.keep_going = true;
    settings_.jobs = 2;
  }
  static std::vector<BatchCase> cases(const std::vector<std::string>& names) {
    std::vector<BatchCase> all;
    for (const auto& name : names) all.push_back({name, {{"input", {name + ".nii"}}}});
    return all;
  }
  BatchResult run(const std::vector<std::string>& names) const { return run_batch(cases(names), settings_, {}); }
  std::ptrdiff_t started() const {
    const std::string text = text_in(folder_ / "started");
    return std::count(text.begin(), text.end(), '\n');
  }

  test::TemporaryFolder folder_;
  BatchSettings settings_;
};

TEST_F(BatchRun, OneBadCaseIsARowAndNotTheEnd) {
  const BatchResult result = run({"a", "crash", "bad", "weak", "z"});
  ASSERT_EQ(result.rows.size(), 5U);
  EXPECT_EQ(result.exit_code(), 1);
  EXPECT_EQ(result.rows[0].status, "ok");
  EXPECT_EQ(result.rows[1].status, "failed");
  EXPECT_EQ(result.rows[1].exit_code, 128 + 11);
  EXPECT_THAT(result.rows[1].message, HasSubstr("signal 11"));
  EXPECT_EQ(result.rows[2].exit_code, 65);
  EXPECT_EQ(result.rows[2].message, "no good (x): because");
  EXPECT_EQ(result.rows[3].status, "ambiguous");
  EXPECT_EQ(result.rows[3].objects, 2);
  EXPECT_DOUBLE_EQ(result.rows[3].volume_ml.value_or(0.0), 4.0);
  EXPECT_EQ(result.rows[4].status, "ok");
  EXPECT_THAT(text_in(folder_ / "out/bad/bad_log.txt"), HasSubstr("first"));
  EXPECT_FALSE(fs::exists(folder_ / "out/a/a_log.txt"));
  // The file says what the result says.
  EXPECT_EQ(table_of(read_batch_table(result.table)), table_of(result.rows));
}

TEST_F(BatchRun, WithoutKeepGoingTheRestIsPendingAndResumeDoesOnlyWhatIsMissing) {
  settings_.jobs = 1;
  settings_.keep_going = false;
  const BatchResult first = run({"a", "bad", "c"});
  EXPECT_EQ(first.rows[2].status, "pending");
  EXPECT_EQ(first.exit_code(), 1);
  EXPECT_EQ(started(), 2);
  EXPECT_THROW(run({"a", "bad", "c"}), CannotCreate);

  settings_.resume = settings_.keep_going = true;
  EXPECT_EQ(run({"a", "bad", "c"}).kept, 1U);
  EXPECT_EQ(started(), 4);
  fs::remove(folder_ / "out/c/c_mask");
  EXPECT_EQ(run({"a", "c"}).exit_code(), 0);
  EXPECT_EQ(started(), 5);
  settings_.common["detail"] = {"1"};  // told otherwise: all are done anew
  EXPECT_EQ(run({"a", "c"}).kept, 0U);
  EXPECT_EQ(started(), 7);
}

TEST_F(BatchRun, PartsJoin) {
  const std::vector<std::string> names{"a", "b", "c", "weak", "e"};
  for (int part = 1; part <= 2; ++part) {
    settings_.shard = {part, 2};
    EXPECT_EQ(run(names).rows.size(), part == 1 ? 3U : 2U);
  }
  EXPECT_FALSE(fs::exists(folder_ / "out/batch.tsv"));
  settings_.shard = {};
  settings_.resume = true;
  const BatchResult joined = run(names);
  EXPECT_EQ(joined.kept, 5U);
  EXPECT_EQ(joined.exit_code(), 3);
  EXPECT_EQ(started(), 5);
}

TEST_F(BatchRun, TheTableIsCompleteWhileItRunsAndAnInterruptEndsTheChildren) {
  std::vector<std::string> states;
  BatchContext context;
  context.finished = [&](const BatchRow&) { states.push_back(text_in(folder_ / "out/batch.tsv")); };
  context.observer.progress = [&](double, const std::string&) {
    if (!states.empty()) throw Interrupted();  // as check_interrupt() would
  };
  settings_.jobs = 2;
  const auto all = cases({"slow", "b", "c"});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THROW(run_batch(all, settings_, context), Interrupted);
  EXPECT_TRUE(std::chrono::steady_clock::now() - begin < std::chrono::seconds(10));
  ASSERT_EQ(states.size(), 1U);
  EXPECT_EQ(std::count(states[0].begin(), states[0].end(), '\n'), 4);
  const auto rows = read_batch_table(folder_ / "out/batch.tsv");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].status, "pending");
  EXPECT_EQ(rows[1].status, "ok");

  // Going on gives the files of a run that nobody disturbed, and clears away what a killed one may have left.
  std::ofstream(folder_ / "quick") << "";
  fs::create_directories(folder_ / "out/slow");
  std::ofstream(folder_ / "out/slow/.slow_mask.4711.part.nii.gz") << "half";
  std::ofstream(folder_ / "out/.batch.4711.part.tsv") << "half";
  const fs::path of_a_shard = folder_ / "out/.batch-2-of-3.4711.part.tsv";  // which may be running now
  std::ofstream(of_a_shard) << "half";
  settings_.resume = true;
  EXPECT_EQ(run_batch(all, settings_, {}).exit_code(), 0);
  EXPECT_TRUE(fs::remove(of_a_shard));
  settings_.resume = false;
  settings_.output = folder_ / "undisturbed";
  EXPECT_EQ(run_batch(all, settings_, {}).exit_code(), 0);
  std::vector<std::string> one, other;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out"))
    one.push_back(fs::relative(entry, folder_ / "out").string());
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "undisturbed"))
    other.push_back(fs::relative(entry, folder_ / "undisturbed").string());
  EXPECT_THAT(one, testing::UnorderedElementsAreArray(other));
}

TEST(BatchTable, SurvivesAwkwardText) {
  BatchRow row;
  row.name = "a b";
  row.arguments = "0123";
  row.message = "two\nlines\tand a tab";
  row.exit_code = 65;
  row.status = "failed";
  const test::TemporaryFolder folder;
  std::ofstream(folder / "batch.tsv") << table_of({row});
  const auto rows = read_batch_table(folder / "batch.tsv");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].message, "two lines and a tab");
  EXPECT_TRUE(rows[0].failed());
  std::ofstream(folder / "batch-1-of-2.tsv") << "other\tcolumns\n";
  EXPECT_THROW(read_batch_tables(folder.path()), BadData);
}

}  // namespace
}  // namespace pellicle
