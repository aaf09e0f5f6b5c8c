// Texts that name settings by their keys.
#include "pellicle/settings/setting_text.h"

#include <gtest/gtest.h>

#include "pellicle/base/errors.h"

namespace pellicle {
namespace {

TEST(SettingText, KeysInBackquotesBecomeNames) {
  EXPECT_EQ(with_setting_names("radius of every `seed-point`, mm", "--"), "radius of every --seed-point, mm");
  EXPECT_EQ(with_setting_names("`a` or `b-2`", "-"), "-a or -b-2");
  EXPECT_EQ(with_setting_names("needs `objects` many", ""), "needs objects many");
  EXPECT_EQ(with_setting_names("nothing to name", "--"), "nothing to name");
  EXPECT_EQ(with_setting_names("", "--"), "");
}

TEST(SettingText, OtherBackquotesStay) {
  EXPECT_EQ(with_setting_names("a ` alone", "--"), "a ` alone");
  EXPECT_EQ(with_setting_names("`Two words` and `FILE` and ``", "--"), "`Two words` and `FILE` and ``");
  EXPECT_EQ(with_setting_names("`/a/b` `key`", "--"), "`/a/b` --key");
}

TEST(SettingError, CarriesKeyValueAndPlace) {
  const SettingError plain("bad value", "detail", "-3", "must be 0 or more");
  EXPECT_STREQ(plain.what(), "bad value (detail -3): must be 0 or more");
  EXPECT_EQ(plain.category(), ErrorCategory::usage);
  const SettingError placed = plain.at("run.toml:3, detail");
  EXPECT_STREQ(placed.what(), "bad value (run.toml:3, detail): must be 0 or more");
  EXPECT_EQ(placed.key, "detail");
  EXPECT_EQ(placed.value, "-3");
  const SettingError two("conflicting settings", "time-step, mass", "keep one");
  EXPECT_STREQ(two.what(), "conflicting settings (time-step, mass): keep one");
}

}  // namespace
}  // namespace pellicle
