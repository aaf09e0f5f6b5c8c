#include "command_settings.h"

#include <fmt/format.h>

#include "pellicle/base/errors.h"
#include "pellicle/settings/setting_fields.h"

namespace pellicle::cli {

namespace {

void check_volume_name(const std::filesystem::path& path, const std::string& key) {
  const std::string name = path.string();
  if (!path.empty() && !name.ends_with(".nii") && !name.ends_with(".nii.gz")) {
    refuse_setting(key, name, "voxels are written as NIfTI; end the name in .nii.gz");
  }
}

SettingKey argument(const char* name, const char* placeholder, const char* help) {
  return {.group = "Input", .name = name, .placeholder = placeholder, .help = help, .argument = true, .required = true};
}

}  // namespace

const SettingTable<ExportSettings>& export_table() {
  using E = ExportSettings;
  static const SettingTable<E> all{
      setting<E>(argument("model", "FILE.json", "a saved model, STEM_model.json"), SETTING_FIELD(model)),
      setting<E>({"Outputs", "mesh", "FILE", "mesh file; .ply, .stl, .obj, .vtp (LPS mm) or .surf.gii (RAS mm)"},
                 SETTING_FIELD(mesh)),
      setting<E>(
          {"Outputs", "density", "N", "2^N facets along a control edge; default: about 300 facets around the object"},
          SETTING_FIELD(density)),
      setting<E>({"Outputs", "control", "FILE", "the control mesh, same formats"}, SETTING_FIELD(control)),
      setting<E>({"Outputs", "mask", "FILE.nii.gz", "0/1 on the grid of `like`"}, SETTING_FIELD(mask)),
      setting<E>({"Outputs", "sdf", "FILE.nii.gz", "signed distance in mm, negative inside, on the grid of `like`"},
                 SETTING_FIELD(sdf)),
      setting<E>({"Outputs", "prob", "FILE.nii.gz", "inside fraction of each voxel on the grid of `like`"},
                 SETTING_FIELD(prob)),
      setting<E>({"Outputs", "like", "VOLUME", "volume whose grid is used"}, SETTING_FIELD(like)),
      setting<E>({"Outputs", "overwrite", "", "replace files that exist"}, SETTING_FIELD(overwrite)),
      setting<E>({"Run", "threads", "N", "threads; 0: all"}, SETTING_FIELD(threads))};
  return all;
}

void ExportSettings::validate() const {
  if (!writes_voxels() && mesh.empty() && control.empty()) {
    throw UsageError(
        "nothing to export (pellicle export): no output is named; give `mesh`, `mask`, `sdf`, `prob` or `control`");
  }
  if (writes_voxels() && like.empty()) {
    throw SettingError("missing setting", "like", "voxels need a grid; give `like` VOLUME");
  }
  if (density && (*density < 0 || *density > 7)) {
    refuse_setting("density", fmt::format("{}", *density), "must be 0 to 7 (2^N facets along a control edge)");
  }
  if (threads < 0) refuse_setting("threads", fmt::format("{}", threads), "must be 0 (all) or more");
  check_volume_name(mask, "mask");
  check_volume_name(sdf, "sdf");
  check_volume_name(prob, "prob");
}

const SettingTable<InfoSettings>& info_table() {
  using I = InfoSettings;
  static const SettingTable<I> all{
      setting<I>(argument("file", "FILE", "volume, folder with a DICOM series, mesh or model"), SETTING_FIELD(file)),
      setting<I>({"Input", "spacing", "X,Y,Z", "voxel size in mm, instead of the file's"}, SETTING_FIELD(spacing)),
      setting<I>({"Outputs", "json", "", "print JSON"}, SETTING_FIELD(json))};
  return all;
}

const SettingTable<ReportSettings>& report_table() {
  using R = ReportSettings;
  static const SettingTable<R> all = [] {
    SettingKey results = argument("result", "PATH", "folders of 'segment' or 'batch', or *_report.json files");
    results.kind = SettingKind::several;
    return SettingTable<R>{
        setting<R>(results, SETTING_FIELD(results)),
        setting<R>({.group = "Outputs",
                    .name = "output",
                    .placeholder = "FILE.html",
                    .help = "the page",
                    .short_flag = "-o",
                    .required = true},
                   SETTING_FIELD(output)),
        setting<R>({"Outputs", "title", "TEXT", "heading of the page"}, SETTING_FIELD(title)),
        setting<R>({"Outputs", "voxels", "N",
                    "volumes are cut out and averaged to at most N x N x N voxels; default 128, fewer for many cases"},
                   SETTING_FIELD(voxels)),
        setting<R>({"Outputs", "no-viewer", "", "without volumes and surfaces: a small page"},
                   SETTING_FIELD(no_viewer)),
        setting<R>({"Outputs", "overwrite", "", "replace the page when it exists"}, SETTING_FIELD(overwrite)),
        setting<R>({"Run", "threads", "N", "threads; 0: all"}, SETTING_FIELD(threads))};
  }();
  return all;
}

void ReportSettings::validate() const {
  if (voxels && (*voxels < 8 || *voxels > 512)) {
    refuse_setting("voxels", fmt::format("{}", *voxels), "must be 8 to 512");
  }
  if (threads < 0) refuse_setting("threads", fmt::format("{}", threads), "must be 0 (all) or more");
}

const SettingTable<BatchFlags>& batch_table() {
  using B = BatchFlags;
  static const SettingTable<B> all = [] {
    SettingKey manifest = argument("manifest", "TABLE",
                                   "table (.csv, .tsv) with a column for each flag of 'segment' and a row for each "
                                   "case; or volumes, also as a pattern: 'scans/*.nii.gz'");
    manifest.kind = SettingKind::several;
    return SettingTable<B>{
        setting<B>(manifest, SETTING_FIELD(manifest)),
        setting<B>({"Batch", "output", "DIR", "folder: batch.tsv, and a folder for each case", "-o"},
                   SETTING_FIELD(output)),
        setting<B>({"Batch", "resume", "", "do only what is missing in DIR, or has other settings now"},
                   SETTING_FIELD(resume)),
        setting<B>({"Batch", "shard", "I/N", "only part I of N of the cases, from 1; its table is batch-I-of-N.tsv"},
                   SETTING_FIELD(shard)),
        setting<B>({"Batch", "keep-going", "", "go on after a case that failed"}, SETTING_FIELD(keep_going)),
        setting<B>({"Batch", "overwrite", "", "start anew and replace files"}, SETTING_FIELD(cases.overwrite)),
        setting<B>({"Run", "jobs", "N", "cases at a time; they share the threads"}, SETTING_FIELD(cases.jobs)),
        setting<B>({"Run", "threads", "N", "threads of all cases together; 0: all"}, SETTING_FIELD(cases.threads))};
  }();
  return all;
}

const SettingTable<BidsFlags>& bids_table() {
  using B = BidsFlags;
  static const SettingTable<B> all = [] {
    SettingKey participants{"Dataset", "participant-label", "LABEL",
                            "only these, with or without 'sub-'; default: all"};
    SettingKey sessions{"Dataset", "session-label", "LABEL", "only these, with or without 'ses-'; default: all"};
    participants.kind = sessions.kind = SettingKind::several;
    return SettingTable<B>{
        setting<B>(argument("bids-dir", "DIR", "a raw BIDS dataset"), SETTING_FIELD(dataset)),
        setting<B>(argument("out", "DIR", "the derivatives dataset, created if missing"), SETTING_FIELD(output)),
        setting<B>(
            argument("level", "participant|group", "participant: segment every image; group: the page of all results"),
            SETTING_FIELD(level)),
        setting<B>(participants, SETTING_FIELD(participants)),
        setting<B>(sessions, SETTING_FIELD(sessions)),
        setting<B>({"Dataset", "suffix", "SUFFIX", "which images of anat/"}, SETTING_FIELD(suffix)),
        setting<B>({"Dataset", "desc", "LABEL", "what the results are called: ..._desc-LABEL_mask.nii.gz"},
                   SETTING_FIELD(desc)),
        setting<B>({"Run", "overwrite", "", "do again what an earlier run finished"}, SETTING_FIELD(cases.overwrite)),
        setting<B>({"Run", "jobs", "N", "images at a time; they share the threads"}, SETTING_FIELD(cases.jobs)),
        setting<B>({"Run", "threads", "N", "threads of all images together; 0: all"}, SETTING_FIELD(cases.threads))};
  }();
  return all;
}

}  // namespace pellicle::cli
