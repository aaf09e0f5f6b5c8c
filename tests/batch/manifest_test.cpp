// The cases of a batch: tables, patterns, parts, and what a case is told.
#include "pellicle/batch/manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "../../cli/exit_codes.h"
#include "../temporary_folder.h"
#include "pellicle/base/errors.h"

namespace pellicle {
namespace {
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<BatchCase> manifest(const test::TemporaryFolder& folder, const std::string& text,
                                const std::string& name = "m.csv") {
  std::ofstream(folder / name, std::ios::binary) << text;
  return read_manifest(folder / name);
}

TEST(Manifest, ReadsWhatSpreadsheetsWrite) {
  const test::TemporaryFolder folder;
  const auto cases = manifest(folder,
                              "\xEF\xBB\xBF"
                              "name , input,seed-sphere,detail\r\n"
                              "# a remark, with a comma\r\n"
                              "a,one.nii.gz,\"1,2,3,4; 5,6,7,8\",2\r\n"
                              "\r\n"
                              "\"b \"\"quoted\"\"\",/data/two.nii.gz,,\r\n"
                              ",sub/three.nii.gz,\"-1,0,0,2\",");
  ASSERT_EQ(cases.size(), 3U);
  EXPECT_EQ(cases[0].name, "a");
  EXPECT_THAT(cases[0].values.at("input"), ElementsAre((folder / "one.nii.gz").string()));
  EXPECT_THAT(cases[0].values.at("seed-sphere"), ElementsAre("1,2,3,4", "5,6,7,8"));
  EXPECT_EQ(cases[1].name, "b \"quoted\"");
  EXPECT_THAT(cases[1].values.at("input"), ElementsAre("/data/two.nii.gz"));
  EXPECT_FALSE(cases[1].values.contains("seed-sphere"));
  EXPECT_EQ(cases[2].name, "three");
}

TEST(Manifest, TabsSeparateATsv) {
  const test::TemporaryFolder folder;
  const auto cases = manifest(folder, "input\tseed-sphere\tenergy\nx.nii\t1,2,3,4\tregion=1;bending=0.5\n", "m.tsv");
  ASSERT_EQ(cases.size(), 1U);
  EXPECT_THAT(cases[0].values.at("seed-sphere"), ElementsAre("1,2,3,4"));
  EXPECT_THAT(cases[0].values.at("energy"), ElementsAre("region=1", "bending=0.5"));
}

struct BadTable {
  std::string text;
  int exit_code;
  std::string message;
};

class BadTables : public testing::TestWithParam<BadTable> {};

TEST_P(BadTables, AreRefusedWithThePlace) {
  const test::TemporaryFolder folder;
  try {
    manifest(folder, GetParam().text);
    FAIL() << "no error";
  } catch (const Error& fault) {
    EXPECT_EQ(cli::exit_code_of(fault.category()), GetParam().exit_code) << fault.what();
    EXPECT_THAT(fault.what(), HasSubstr(GetParam().message));
    EXPECT_THAT(fault.what(), HasSubstr("m.csv"));
    EXPECT_THAT(fault.what(), testing::Not(HasSubstr("\n")));
  }
}

INSTANTIATE_TEST_SUITE_P(Manifest, BadTables,
                         testing::Values(BadTable{"input,colour\na.nii,red\n", 64, "m.csv:1, column 'colour'"},
                                         BadTable{"input,threads\na.nii,2\n", 64, "same for all cases"},
                                         BadTable{"input,detail,detail\na.nii,1,1\n", 64, "doubled column"},
                                         BadTable{"name,detail\na,1\n", 64, "no column 'input'"},
                                         BadTable{"input,detail\na.nii,1\nb.nii,few\n", 64, "m.csv:3, column 'detail'"},
                                         BadTable{"input,polarity\na.nii,blue\n", 64, "column 'polarity'"},
                                         BadTable{"input,detail\n,1\n", 64, "no volume"},
                                         BadTable{"input\nx/a.nii\ny/a.nii.gz\n", 64, "doubled case name"},
                                         BadTable{"name,input\na/b,a.nii\n", 64, "bad case name"},
                                         BadTable{"name,input\n..,a.nii\n", 64, "bad case name"},
                                         BadTable{"input,seed-sphere\na.nii,1,2,3,4\n", 65, "5 cells, but 2 columns"},
                                         BadTable{"input,name\n\"a.nii,b\n\n", 65, "m.csv:2"},
                                         BadTable{"input,name\n\"a.nii\"x,b\n", 65, "text after a quoted cell"},
                                         BadTable{"", 65, "empty table"}, BadTable{"input\n", 65, "no row"}));

TEST(Manifest, PatternsNameTheirFiles) {
  const test::TemporaryFolder folder;
  for (const std::string name : {"b.nii.gz", "a.nii.gz", "c.txt"}) std::ofstream(folder / name) << "x";
  const auto cases = cases_of_patterns({(folder / "*.nii.gz").string()});
  ASSERT_EQ(cases.size(), 2U);
  EXPECT_EQ(cases[0].name, "a");
  EXPECT_THAT(cases[1].values.at("input"), ElementsAre((folder / "b.nii.gz").string()));
  EXPECT_THROW(cases_of_patterns({(folder / "*.mha").string()}), NoInput);
  EXPECT_THROW(cases_of_patterns({(folder / "a*").string(), (folder / "*.gz").string()}), UsageError);
  EXPECT_THROW(read_manifest(folder / "none.csv"), NoInput);
}

TEST(Manifest, PartsAreDisjointAndComplete) {
  std::vector<BatchCase> all;
  for (int i = 0; i < 11; ++i) all.push_back({"case" + std::to_string(i), {}});
  for (int count = 1; count <= 13; ++count) {
    std::multiset<std::string> seen;
    for (int index = 1; index <= count; ++index) {
      const auto part = cases_of_shard(all, {index, count});
      EXPECT_LE(part.size(), all.size() / static_cast<std::size_t>(count) + 1);
      for (const auto& one : part) seen.insert(one.name);
    }
    std::multiset<std::string> expected;
    for (const auto& one : all) expected.insert(one.name);
    EXPECT_EQ(seen, expected) << count;
  }
  for (const std::string text : {"0/3", "4/3", "2", "1/", "a/b", "-1/2", "1/0"}) {
    EXPECT_THROW(parse_shard(text), UsageError) << text;
  }
  EXPECT_EQ(parse_shard("2/8").index, 2);
  EXPECT_EQ(parse_shard("2/8").count, 8);
}

TEST(Manifest, TheCaseWinsOverWhatIsCommon) {
  const FlagValues common{
      {"polarity", {"bright"}}, {"detail", {"2"}}, {"energy", {"region=1"}}, {"seed-auto", {"true"}}};
  const BatchCase plain{"a", {{"input", {"a.nii"}}}};
  EXPECT_THAT(arguments_of(plain, common),
              ElementsAre("--detail=2", "--energy=region=1", "--input=a.nii", "--polarity=bright", "--seed-auto=true"));
  const BatchCase own{
      "b", {{"input", {"b.nii"}}, {"polarity", {"dark"}}, {"energy", {"region=2"}}, {"seed-sphere", {"-1,2,3,4"}}}};
  EXPECT_THAT(arguments_of(own, common), ElementsAre("--detail=2", "--energy=region=1", "--energy=region=2",
                                                     "--input=b.nii", "--polarity=dark", "--seed-sphere=-1,2,3,4"));
}

}  // namespace
}  // namespace pellicle
