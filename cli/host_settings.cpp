#include "command_flags.h"
#include "pellicle/settings/setting_fields.h"

namespace pellicle::cli {

namespace {

SettingTable<HostSettings> dry_run_row(const char* help) {
  return {setting<HostSettings>({.group = "Run", .name = "dry-run", .help = help, .recorded = false},
                                SETTING_FIELD(dry_run))};
}

}  // namespace

const SettingTable<HostSettings>& console_table() {
  static const SettingTable<HostSettings> all{
      setting<HostSettings>({"Run", "quiet", "", "print only errors on stderr", "-q"}, SETTING_FIELD(console.quiet)),
      setting<HostSettings>({"Run", "verbose", "", "also print what is being done", "-v"},
                            SETTING_FIELD(console.verbose)),
      setting<HostSettings>({"Run", "log-json", "", "write logs as one JSON object per line"},
                            SETTING_FIELD(console.json)),
      setting<HostSettings>({"Run", "no-progress", "", "no progress bar"}, SETTING_FIELD(console.no_progress))};
  return all;
}

const SettingTable<HostSettings>& dry_run_table() {
  static const SettingTable<HostSettings> all =
      joined(dry_run_row("print the resolved settings as TOML and stop"), console_table());
  return all;
}

const SettingTable<HostSettings>& segment_host_table() {
  static const SettingTable<HostSettings> all = [] {
    SettingTable<HostSettings> table =
        joined(dry_run_row("print the resolved settings as TOML and stop; with `input` and `output` also print what "
                           "would be done and draw the seeds"),
               console_table());
    table.push_back(setting<HostSettings>({"Run", "progress-xml", "", "progress on stdout as 3D Slicer reads it"},
                                          SETTING_FIELD(progress_xml)));
    return table;
  }();
  return all;
}

}  // namespace pellicle::cli
