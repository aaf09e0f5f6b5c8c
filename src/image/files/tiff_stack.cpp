#include "pellicle/image/files/internal/tiff_stack.h"

#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstring>
#include <memory>

#include "pellicle/image/files/internal/tiff_spacing.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

int keep_first_error(TIFF*, void* user_data, const char*, const char* format, va_list arguments) {
  auto& kept = *static_cast<std::string*>(user_data);
  if (kept.empty()) {
    std::array<char, 256> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    kept = text.data();
  }
  return 1;  // handled: nothing goes to stderr
}

int ignore_warning(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

// An open TIFF and the first complaint of libtiff about it.
struct TiffFile {
  fs::path path;
  std::string error;
  TIFF* tiff = nullptr;

  explicit TiffFile(fs::path p) : path(std::move(p)) {
    const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                   &TIFFOpenOptionsFree);
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_first_error, &error);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), ignore_warning, nullptr);
    tiff = TIFFOpenExt(path.c_str(), "r", options.get());
    if (tiff == nullptr) fail();
  }
  ~TiffFile() {
    if (tiff != nullptr) TIFFClose(tiff);
  }
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  [[noreturn]] void fail() const {
    throw_bad_volume(
        path, fmt::format("damaged, truncated or not a TIFF ({})", error.empty() ? "libtiff gives no reason" : error),
        "copy or export the file again");
  }
};

struct Page {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, format = SAMPLEFORMAT_UINT, samples = 1, photometric = PHOTOMETRIC_MINISBLACK,
                compression = COMPRESSION_NONE;
  bool operator==(const Page&) const = default;
};

Page current_page(TIFF* tiff) {
  Page page;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &page.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &page.height);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &page.bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &page.format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &page.samples);
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &page.photometric);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &page.compression);
  return page;
}

bool is_reduced(TIFF* tiff) {
  std::uint32_t kind = 0;
  return TIFFGetField(tiff, TIFFTAG_SUBFILETYPE, &kind) != 0 && (kind & FILETYPE_REDUCEDIMAGE) != 0;
}

std::optional<double> resolution(TIFF* tiff, std::uint32_t tag) {
  float value = 0.0F;
  return TIFFGetField(tiff, tag, &value) != 0 ? std::optional<double>(value) : std::nullopt;
}

TiffDescription current_description(TIFF* tiff) {
  TiffDescription description;
  const char* text = nullptr;
  if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text) != 0 && text != nullptr) description.text = text;
  description.x_resolution = resolution(tiff, TIFFTAG_XRESOLUTION);
  description.y_resolution = resolution(tiff, TIFFTAG_YRESOLUTION);
  return description;
}

ComponentType component_of(const Page& page, const fs::path& path) {
  if (page.photometric == PHOTOMETRIC_RGB || page.photometric == PHOTOMETRIC_YCBCR || page.samples > 1) {
    throw_bad_volume(path, fmt::format("the voxels are RGB colours or {} channels", page.samples),
                     "convert them to one grey value each");
  }
  switch (page.format) {
    case SAMPLEFORMAT_VOID:
    case SAMPLEFORMAT_UINT:
      if (page.bits == 8) return ComponentType::uint8;
      if (page.bits == 16) return ComponentType::uint16;
      if (page.bits == 32) return ComponentType::uint32;
      if (page.bits == 64) return ComponentType::uint64;
      break;
    case SAMPLEFORMAT_INT:
      if (page.bits == 8) return ComponentType::int8;
      if (page.bits == 16) return ComponentType::int16;
      if (page.bits == 32) return ComponentType::int32;
      if (page.bits == 64) return ComponentType::int64;
      break;
    case SAMPLEFORMAT_IEEEFP:
      if (page.bits == 32) return ComponentType::float32;
      if (page.bits == 64) return ComponentType::float64;
      break;
    case SAMPLEFORMAT_COMPLEXINT:
    case SAMPLEFORMAT_COMPLEXIEEEFP:
      throw_bad_volume(path, "the voxels are complex numbers", "convert them to magnitudes");
    default:
      break;
  }
  throw_bad_volume(path, fmt::format("voxels of {} bits are not supported", page.bits),
                   "convert them to 8, 16 or 32 bits");
}

// The directories that are full-size pages, in order. All must agree.
std::vector<std::uint32_t> find_pages(TiffFile& file, const Page& first) {
  std::vector<std::uint32_t> pages;
  std::uint32_t directory = 0;
  do {
    if (!is_reduced(file.tiff)) {
      Page page = current_page(file.tiff);
      page.compression = first.compression;
      if (!(page == first)) {
        throw_bad_volume(file.path,
                         fmt::format("page {} is {}x{} of {} bits, page 1 is {}x{} of {} bits", directory + 1,
                                     page.width, page.height, page.bits, first.width, first.height, first.bits),
                         "all pages of a stack must be of one size and type");
      }
      pages.push_back(directory);
    }
    ++directory;
  } while (TIFFReadDirectory(file.tiff) != 0);
  if (!file.error.empty()) file.fail();
  return pages;
}

void check_one_volume(const TiffSpacing& spacing, int pages, const fs::path& path) {
  if (spacing.channels > 1 || spacing.frames > 1) {
    throw_bad_volume(
        path, fmt::format("4D data: {} channels and {} time points in one stack", spacing.channels, spacing.frames),
        "extract one channel and one time point first");
  }
  if (pages == 1 && spacing.slices > 1) {
    throw_bad_volume(path, fmt::format("the description tells of {} slices, but the file has one page", spacing.slices),
                     "save the stack as a multi-page or OME TIFF in one file");
  }
  if (pages == 1) throw_bad_volume(path, "a single page, which is a 2D image", "give a stack of pages, one per slice");
  if (spacing.slices > 0 && spacing.slices != pages) {
    throw_bad_volume(path,
                     fmt::format("the description tells of {} slices, the file has {} pages", spacing.slices, pages),
                     "the file is truncated or its description is out of date; save it again");
  }
}

void read_tiles(TiffFile& file, const Page& page, std::size_t width, std::vector<std::byte>& out) {
  std::uint32_t tile_width = 0, tile_height = 0;
  TIFFGetField(file.tiff, TIFFTAG_TILEWIDTH, &tile_width);
  TIFFGetField(file.tiff, TIFFTAG_TILELENGTH, &tile_height);
  const auto tile_bytes = static_cast<std::size_t>(TIFFTileSize(file.tiff));
  if (tile_width == 0 || tile_height == 0 || tile_bytes < width * tile_width * tile_height) file.fail();
  std::vector<std::byte> tile(tile_bytes);
  for (std::uint32_t y = 0; y < page.height; y += tile_height) {
    for (std::uint32_t x = 0; x < page.width; x += tile_width) {
      if (TIFFReadTile(file.tiff, tile.data(), x, y, 0, 0) < 0) file.fail();
      const std::size_t columns = std::min(tile_width, page.width - x), rows = std::min(tile_height, page.height - y);
      for (std::size_t row = 0; row < rows; ++row) {
        std::memcpy(out.data() + ((y + row) * page.width + x) * width, tile.data() + row * tile_width * width,
                    columns * width);
      }
    }
  }
}

void read_strips(TiffFile& file, std::vector<std::byte>& out) {
  std::size_t done = 0;
  const std::uint32_t strips = TIFFNumberOfStrips(file.tiff);
  for (std::uint32_t strip = 0; strip < strips && done < out.size(); ++strip) {
    const auto got =
        TIFFReadEncodedStrip(file.tiff, strip, out.data() + done, static_cast<tmsize_t>(out.size() - done));
    if (got <= 0) file.fail();
    done += static_cast<std::size_t>(got);
  }
  if (done < out.size()) file.fail();
}

}  // namespace

VolumeSource open_tiff_stack(const fs::path& path) {
  auto file = std::make_shared<TiffFile>(path);
  const Page first = current_page(file->tiff);
  TiffDescription description = current_description(file->tiff);
  const ComponentType type = component_of(first, path);
  const std::vector<std::uint32_t> pages = find_pages(*file, first);
  description.pages = static_cast<int>(pages.size());
  const TiffSpacing spacing = tiff_spacing(description);
  check_one_volume(spacing, description.pages, path);
  check_size(path, {first.width, first.height, description.pages});

  VolumeSource source;
  VolumeHeader& header = source.header;
  header.format = spacing.source.empty() ? "TIFF" : fmt::format("TIFF ({})", spacing.source);
  header.component_type = name_of(type);
  header.grid.size = {static_cast<int>(first.width), static_cast<int>(first.height), description.pages};
  header.grid.spacing = spacing.spacing;
  header.unit = spacing.unit;
  header.spacing_known = spacing.known;
  header.warnings = spacing.warnings;
  const std::size_t width = size_in_bytes(type);
  const std::size_t page_voxels = static_cast<std::size_t>(first.width) * first.height;
  std::error_code failure;
  // Without compression the claim is exact; the best codecs pack constant pages beyond any fixed ratio, page by page.
  if (first.compression == COMPRESSION_NONE)
    check_claim(path, page_voxels * pages.size() * width, fs::file_size(path, failure), false);
  source.read_blocks = [file, pages, first, type, width, page_voxels](const auto& consume) {
    std::vector<std::byte> bytes(page_voxels * width);
    for (const std::uint32_t directory : pages) {
      if (TIFFSetDirectory(file->tiff, static_cast<tdir_t>(directory)) == 0) file->fail();
      if (TIFFIsTiled(file->tiff) != 0)
        read_tiles(*file, first, width, bytes);
      else
        read_strips(*file, bytes);
      consume({type, bytes.data(), page_voxels});
    }
  };
  return source;
}

}  // namespace pellicle
