#include "pellicle/batch/bids.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/batch/page_cases.h"
#include "pellicle/output/outputs.h"
#include "pellicle/output/provenance.h"
#include "pellicle/settings/settings.h"

namespace pellicle {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* kWorkFolder = "pellicle";  // reports, models, meshes: no BIDS names, see .bidsignore

bool is_bids_label(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c) != 0 && c < 128; });
}

std::string with_prefix(const std::string& label, const std::string& prefix) {
  return label.starts_with(prefix) ? label : prefix + label;
}

std::vector<fs::path> folders_in(const fs::path& folder, const std::string& prefix) {
  std::vector<fs::path> found;
  std::error_code fault;
  for (fs::directory_iterator at(folder, fault), end; !fault && at != end; at.increment(fault)) {
    std::error_code ignored;
    if (at->path().filename().string().starts_with(prefix) && at->is_directory(ignored)) found.push_back(at->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

// Those that are asked for, or all.
std::vector<fs::path> chosen_folders(const fs::path& folder, const std::string& prefix,
                                     const std::vector<std::string>& labels) {
  std::vector<fs::path> all = folders_in(folder, prefix);
  if (labels.empty()) return all;
  std::erase_if(all, [&](const fs::path& one) {
    return std::none_of(labels.begin(), labels.end(), [&](const std::string& label) {
      return with_prefix(label, prefix) == one.filename().string();
    });
  });
  return all;
}

void add_images(const fs::path& folder, const BidsSettings& settings, std::vector<BidsImage>& images) {
  std::error_code fault;
  for (fs::directory_iterator at(folder / "anat", fault), end; !fault && at != end; at.increment(fault)) {
    const std::string name = at->path().filename().string();
    for (const std::string extension : {".nii.gz", ".nii"}) {
      if (!name.ends_with("_" + settings.suffix + extension)) continue;
      images.push_back({fs::relative(at->path(), settings.dataset), name.substr(0, name.size() - extension.size())});
    }
  }
}

Json dataset_description(const BidsSettings& settings) {
  Json description;
  description["Name"] = "Pellicle: segmentations";
  description["BIDSVersion"] = "1.9.0";
  description["DatasetType"] = "derivative";
  description["GeneratedBy"] =
      Json::array({{{"Name", "pellicle"},
                    {"Version", program_version()},
                    {"Description", fmt::format("few-parameter deformable surfaces on {} images", settings.suffix)}}});
  // The sources of each file are named in the raw dataset by BIDS URIs: bids:raw:...
  const std::string raw = fs::relative(fs::absolute(settings.dataset), fs::absolute(settings.output)).generic_string();
  description["DatasetLinks"] = {{"raw", raw}};
  description["SourceDatasets"] = Json::array({{{"URL", raw}}});
  return description;
}

void check_output_dataset(const BidsSettings& settings) {
  std::error_code ignored;
  if (fs::equivalent(settings.dataset, settings.output, ignored)) {
    throw UsageError(fmt::format("output is the input ({}): raw data stay as they are; choose another folder",
                                 settings.output.string()));
  }
  const fs::path file = settings.output / "dataset_description.json";
  if (!fs::exists(file, ignored)) return;
  std::ifstream in(file);
  const Json known = Json::parse(in, nullptr, false);
  const bool listed = known.is_object() && known.contains("GeneratedBy") && known["GeneratedBy"].is_array();
  const bool own = listed && std::any_of(known["GeneratedBy"].begin(), known["GeneratedBy"].end(), [](const Json& by) {
                     return by.is_object() && by.value("Name", "") == "pellicle";
                   });
  if (own) return;
  throw CannotCreate(
      fmt::format("a dataset of something else ({}): its dataset_description.json does not name "
                  "pellicle; choose another folder",
                  settings.output.string()));
}

void write_dataset_files(const BidsSettings& settings) {
  create_folder(settings.output);
  write_text_file(settings.output / "dataset_description.json", dataset_description(settings).dump(2) + "\n");
  write_text_file(settings.output / ".bidsignore", fmt::format("{}/\n", kWorkFolder));
  write_text_file(
      settings.output / "README.md",
      fmt::format("# Segmentations by Pellicle {}\n\n`sub-*/` holds the masks (or label maps), `pellicle/` what came "
                  "with them: reports, models,\nmeshes, pictures and the table of all cases. A sidecar's "
                  "`FitStatus` other than `ok` wants a look\nat the picture before the mask is used.\n",
                  program_version()));
}

void copy_into_place(const fs::path& from, const fs::path& to) {
  create_folder(to.parent_path());
  AtomicFile file(to);
  std::error_code fault;
  fs::copy_file(from, file.path(), fs::copy_options::overwrite_existing, fault);
  if (fault) throw IoError(fmt::format("cannot copy ({}): {}; check the disk", to.string(), fault.message()));
  file.commit();
}

Json sidecar_of(const BidsSettings& settings, const BidsImage& image, const BatchRow& row, bool mask) {
  const std::string source = fmt::format("bids:raw:{}", image.path.generic_string());
  Json sidecar;
  sidecar["Description"] = mask ? "Voxels whose centres lie inside a smooth closed surface fitted to the image"
                                : "Voxels inside smooth closed surfaces fitted to the image, a label each";
  sidecar["Sources"] = Json::array({source});
  sidecar["SpatialReference"] = source;  // space-orig: the grid of the image itself
  if (mask) sidecar["Type"] = settings.desc == "brain" ? "Brain" : "ROI";
  if (!mask) sidecar["Manual"] = false;
  sidecar["FitStatus"] = row.status;
  if (row.volume_ml) sidecar["VolumeMl"] = *row.volume_ml;
  return sidecar;
}

void write_derivative(const BidsSettings& settings, const BidsImage& image, const BatchRow& row) {
  const fs::path work = settings.output / kWorkFolder / image.stem;
  const std::string start = fmt::format("{}_space-orig_desc-{}", image.entities(), settings.desc);
  const fs::path folder = settings.output / image.path.parent_path();
  std::error_code ignored;
  for (const std::string suffix : {"mask", "dseg"}) {
    const fs::path made = work / fmt::format("{}_{}.nii.gz", image.stem, suffix);
    if (!fs::exists(made, ignored)) continue;
    const std::string name = fmt::format("{}_{}", start, suffix);
    copy_into_place(made, folder / (name + ".nii.gz"));
    write_text_file(folder / (name + ".json"), sidecar_of(settings, image, row, suffix == "mask").dump(2) + "\n");
    const fs::path table = work / fmt::format("{}_{}.tsv", image.stem, suffix);
    if (fs::exists(table, ignored)) copy_into_place(table, folder / (name + ".tsv"));
  }
}

// A table for each choice of participants, so that runs side by side do not share one.
std::string bids_table_name(const BidsSettings& settings) {
  std::string name = "batch";
  for (const auto& label : settings.participants) name += fmt::format("-{}", with_prefix(label, "sub-"));
  for (const auto& label : settings.sessions) name += fmt::format("-{}", with_prefix(label, "ses-"));
  return name + ".tsv";
}

}  // namespace

void BidsSettings::validate() const {
  if (!is_bids_label(suffix)) throw SettingError("bad value", "suffix", suffix, "must be letters and digits");
  if (!is_bids_label(desc)) throw SettingError("bad value", "desc", desc, "must be letters and digits");
  const auto wanted = common.find("write");
  if (wanted == common.end()) return;
  const auto kinds = split_commas(wanted->second.front());
  if (std::find(kinds.begin(), kinds.end(), "mask") == kinds.end()) {
    throw SettingError("nothing for the dataset", "write", wanted->second.front(), "masks are what it holds; add mask");
  }
}

std::string BidsImage::entities() const {
  return stem.substr(0, stem.rfind('_'));
}

std::vector<BidsImage> find_bids_images(const BidsSettings& settings) {
  std::error_code ignored;
  if (!fs::is_directory(settings.dataset, ignored)) {
    throw NoInput(
        fmt::format("no such dataset ({}): there is no folder here; check the path", settings.dataset.string()));
  }
  for (const auto& label : settings.participants) {
    if (fs::is_directory(settings.dataset / with_prefix(label, "sub-"), ignored)) continue;
    throw NoInput(fmt::format("no such participant (`participant-label` {}): {} has no folder {}", label,
                              settings.dataset.string(), with_prefix(label, "sub-")));
  }
  std::vector<BidsImage> images;
  for (const fs::path& subject : chosen_folders(settings.dataset, "sub-", settings.participants)) {
    if (settings.sessions.empty()) add_images(subject, settings, images);
    for (const fs::path& session : chosen_folders(subject, "ses-", settings.sessions)) {
      add_images(session, settings, images);
    }
  }
  if (images.empty()) {
    throw NoInput(fmt::format("no image ({}): no sub-*/[ses-*/]anat/*_{}.nii[.gz] is here; see `suffix`",
                              settings.dataset.string(), settings.suffix));
  }
  std::sort(images.begin(), images.end(), [](const BidsImage& a, const BidsImage& b) { return a.path < b.path; });
  return images;
}

BatchResult run_bids_participants(const BidsSettings& settings, const BatchContext& context) {
  settings.validate();
  const std::vector<BidsImage> images = find_bids_images(settings);
  check_output_dataset(settings);
  std::vector<BatchCase> cases;
  cases.reserve(images.size());
  for (const auto& image : images) {
    cases.push_back({image.stem, {{"input", {(settings.dataset / image.path).string()}}}});
  }
  BatchSettings batch;
  batch.program = settings.program;
  batch.output = settings.output / kWorkFolder;
  batch.common = settings.common;
  batch.table = bids_table_name(settings);
  batch.jobs = settings.jobs;
  batch.threads = settings.threads;
  batch.resume = !settings.overwrite;
  batch.overwrite = settings.overwrite;
  batch.keep_going = settings.keep_going;
  batch.validate();
  write_dataset_files(settings);
  BatchResult result = run_batch(cases, batch, context);
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (result.rows[i].done()) write_derivative(settings, images[i], result.rows[i]);
  }
  return result;
}

fs::path write_bids_group_page(const BidsSettings& settings, const Observer& observer) {
  const fs::path work = settings.output / kWorkFolder;
  fs::path page = work / "report.html";
  std::error_code ignored;
  if (!fs::is_directory(work, ignored)) {
    throw NoInput(fmt::format("nothing to gather ({}): run the level 'participant' first", settings.output.string()));
  }
  PageSettings look;
  look.title = fmt::format("Pellicle: {}", settings.dataset.filename().string());
  write_text_file(page, page_of(find_page_cases({work}), look, observer));
  return page;
}

}  // namespace pellicle
