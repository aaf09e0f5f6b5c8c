// What holds for every setting of every command, whatever its table.
#include "pellicle/settings/setting_table.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "../../cli/command_flags.h"
#include "../../cli/command_settings.h"
#include "../../cli/phantom_settings.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"
#include "pellicle/settings/evaluate_settings.h"
#include "pellicle/settings/geometry_fit_settings.h"
#include "pellicle/settings/morph_settings.h"
#include "pellicle/settings/settings.h"
#include "pellicle/settings/toml_settings.h"

namespace pellicle {
namespace {

using cli::BatchFlags;
using cli::BidsFlags;
using cli::ExportSettings;
using cli::HostSettings;
using cli::InfoSettings;
using cli::PhantomCommand;
using cli::ReportSettings;

template <class S>
const SettingTable<S>& table();
template <>
const SettingTable<SegmentSettings>& table() {
  return segment_table();
}
template <>
const SettingTable<GeometryFitSettings>& table() {
  return geometry_fit_table();
}
template <>
const SettingTable<MorphSettings>& table() {
  return morph_table();
}
template <>
const SettingTable<EvaluateSettings>& table() {
  return evaluate_table();
}
template <>
const SettingTable<ExportSettings>& table() {
  return cli::export_table();
}
template <>
const SettingTable<InfoSettings>& table() {
  return cli::info_table();
}
template <>
const SettingTable<ReportSettings>& table() {
  return cli::report_table();
}
template <>
const SettingTable<PhantomCommand>& table() {
  return cli::phantom_table();
}
template <>
const SettingTable<BatchFlags>& table() {
  return cli::batch_table();
}
template <>
const SettingTable<BidsFlags>& table() {
  return cli::bids_table();
}
template <>
const SettingTable<HostSettings>& table() {
  return cli::segment_host_table();
}

template <class S>
class EveryTable : public testing::Test {};

using Tables = testing::Types<SegmentSettings, GeometryFitSettings, MorphSettings, EvaluateSettings, ExportSettings,
                              InfoSettings, ReportSettings, PhantomCommand, BatchFlags, BidsFlags, HostSettings>;
TYPED_TEST_SUITE(EveryTable, Tables);

std::size_t pick(RandomEngine& random, std::size_t count) {
  return static_cast<std::size_t>(random.uniform() * static_cast<double>(count));
}

std::string number_text(const SettingKey& key, RandomEngine& random) {
  if (key.whole) return std::to_string(static_cast<int>(random.uniform(-1000, 1000)));
  return fmt::format("{}", random.normal() * std::pow(10.0, random.uniform(-12, 12)));  // with all its bits in use
}

// How many numbers a vector takes, by its placeholder: "X,Y,Z".
std::size_t length_of(const SettingKey& key) {
  return static_cast<std::size_t>(std::count(key.placeholder.begin(), key.placeholder.end(), ',')) + 1;
}

std::string vector_text(const SettingKey& key, RandomEngine& random) {
  SettingValues words;
  // Sizes are whole numbers, which any other vector takes as well.
  for (std::size_t i = 0; i < length_of(key); ++i) words.push_back(std::to_string(pick(random, 500)));
  return joined_by_commas(words);
}

// Some value of the setting's kind.
SettingValues some_value(const SettingKey& key, RandomEngine& random) {
  switch (key.kind) {
    case SettingKind::flag:
      return {pick(random, 2) == 0 ? "true" : "false"};
    case SettingKind::number:
      return {number_text(key, random)};
    case SettingKind::text: {
      const auto choices = key.choices();
      if (choices.empty()) return {"a \"quoted\" näme\\with\tall"};
      return {choices[pick(random, choices.size())]};
    }
    case SettingKind::words:
    case SettingKind::several:
      return {"one", "two words"};
    case SettingKind::vector:
      return split_commas(vector_text(key, random));
    case SettingKind::vectors:
      return {vector_text(key, random), vector_text(key, random)};
    case SettingKind::table:
      return {"edge=" + number_text(key, random), "flux=" + number_text(key, random)};
  }
  return {};
}

TYPED_TEST(EveryTable, EachKeyIsUniqueDescribedAndComplete) {
  std::set<std::string> names, short_flags;
  for (const auto& row : table<TypeParam>()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name << " stands twice";
    EXPECT_THAT(row.name, testing::MatchesRegex("[a-z][a-z0-9-]*"));
    EXPECT_FALSE(row.group.empty()) << row.name;
    EXPECT_FALSE(row.help.empty()) << row.name;
    EXPECT_TRUE(row.set && row.get) << row.name;
    EXPECT_EQ(row.placeholder.empty(), row.kind == SettingKind::flag) << row.name;
    EXPECT_TRUE(row.short_flag.empty() || short_flags.insert(row.short_flag).second) << row.short_flag;
    EXPECT_EQ(row.help.find("--"), std::string::npos) << row.name << ": other settings are named by key";
  }
}

TYPED_TEST(EveryTable, WhatWasSetIsWhatOneGets) {
  RandomEngine random(11);
  for (const auto& row : table<TypeParam>()) {
    for (int trial = 0; trial < 20; ++trial) {
      const SettingValues value = some_value(row, random);
      TypeParam settings, again;
      row.set(settings, value);
      const SettingValues got = row.get(settings);
      row.set(again, got);
      EXPECT_EQ(row.get(again), got) << row.name;
      EXPECT_EQ(got, value) << row.name;
    }
  }
}

TYPED_TEST(EveryTable, TomlRoundTripIsTheSameBytes) {
  RandomEngine random(12);
  for (int trial = 0; trial < 20; ++trial) {
    TypeParam before, after;
    for (const auto& row : table<TypeParam>()) row.set(before, some_value(row, random));
    const std::string text = toml_of(entries_of(table<TypeParam>(), before));
    apply_toml_text(text, "test.toml", "test", targets_of(table<TypeParam>(), after));
    EXPECT_EQ(toml_of(entries_of(table<TypeParam>(), after)), text);
  }
}

TYPED_TEST(EveryTable, DefaultsRoundTrip) {
  TypeParam after;
  const std::string text = toml_of(entries_of(table<TypeParam>(), TypeParam{}));
  apply_toml_text(text, "test.toml", "test", targets_of(table<TypeParam>(), after));
  EXPECT_EQ(toml_of(entries_of(table<TypeParam>(), after)), text);
}

// Values that no setting of this kind takes; none where every text is a value.
std::vector<SettingValues> bad_values(const SettingKey& key) {
  switch (key.kind) {
    case SettingKind::flag:
      return {{"maybe"}, {"1"}, {""}};
    case SettingKind::number:
      return key.whole ? std::vector<SettingValues>{{"x"}, {"1.5"}, {""}, {"99999999999999999999"}}
                       : std::vector<SettingValues>{{"x"}, {""}, {"nan"}, {"inf"}, {"1,2"}};
    case SettingKind::vector:
      return {{"x"}, {"1", "x"}, {"1", "nan", "2"}};
    case SettingKind::vectors:
      return {{"x"}, {"1"}, {"1,2,3,4,5,6"}};
    case SettingKind::table:
      return {{"edge"}, {"=1"}, {"edge=x"}};
    case SettingKind::text:
    case SettingKind::words:
    case SettingKind::several:
      break;
  }
  return {};
}

TYPED_TEST(EveryTable, BadValuesNameTheKey) {
  for (const auto& row : table<TypeParam>()) {
    for (const SettingValues& value : bad_values(row)) {
      TypeParam settings;
      try {
        row.set(settings, value);
        ADD_FAILURE() << row.name << " takes " << joined_by_commas(value);
      } catch (const SettingError& fault) {
        EXPECT_EQ(fault.key, row.name);
        EXPECT_FALSE(fault.why.empty());
      }
    }
  }
}

TYPED_TEST(EveryTable, BadValuesInFilesNameFileLineAndKey) {
  for (const auto& row : table<TypeParam>()) {
    TypeParam settings;
    try {
      apply_toml_text("\n" + row.name + " = 1979-05-27\n", "my.toml", "test", targets_of(table<TypeParam>(), settings));
      ADD_FAILURE() << row.name << " takes a date";
    } catch (const UsageError& fault) {
      EXPECT_THAT(fault.what(), testing::HasSubstr("(my.toml:2, " + row.name + ")"));
    }
  }
}

TEST(Words, ThatAreNotChoicesAreRefusedWithTheChoices) {
  const auto refusal = [](const auto& rows, auto settings, const std::string& key) -> std::string {
    for (const auto& row : rows) {
      if (row.name != key) continue;
      try {
        row.set(settings, {"pink"});
      } catch (const SettingError& fault) {
        return fault.why;
      }
    }
    return "accepted";
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal(segment_table(), SegmentSettings{}, "polarity"), HasSubstr("auto, bright, dark"));
  EXPECT_THAT(refusal(morph_table(), MorphSettings{}, "space"), HasSubstr("plane, sphere"));
  EXPECT_THAT(refusal(geometry_fit_table(), GeometryFitSettings{}, "tolerance-of"), HasSubstr("rms, p95, max"));
  EXPECT_THAT(refusal(cli::phantom_table(), PhantomCommand{}, "noise"), HasSubstr("rician"));
  EXPECT_THAT(refusal(cli::phantom_table(), PhantomCommand{}, "fill"), HasSubstr("solid, shell"));
}

}  // namespace
}  // namespace pellicle
