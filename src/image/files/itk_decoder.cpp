#include "pellicle/image/files/internal/itk_decoder.h"

#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <cctype>
#include <iostream>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <streambuf>

namespace pellicle {
namespace {

// MetaIO prints its complaints to std::cout and std::cerr, ITK warnings of its own: users get one line from us.
class QuietItk {
 public:
  QuietItk() : lock_(mutex()), out_(std::cout.rdbuf(nowhere_.rdbuf())), err_(std::cerr.rdbuf(nowhere_.rdbuf())) {
    itk::Object::GlobalWarningDisplayOff();
  }
  ~QuietItk() {
    std::cout.rdbuf(out_);
    std::cerr.rdbuf(err_);
  }
  QuietItk(const QuietItk&) = delete;
  QuietItk& operator=(const QuietItk&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
  std::ostringstream nowhere_;
  std::streambuf *out_, *err_;
};

// ITK's text spans lines, from class names and paths to the reason itself: the last line is what a user can use.
std::runtime_error one_line(const itk::ExceptionObject& error) {
  std::istringstream lines(error.GetDescription());
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    const auto begin = line.find_first_not_of(" \t\r");
    if (begin != std::string::npos) text = line.substr(begin);
  }
  const auto address = text.find("): ");
  if (address != std::string::npos) text = text.substr(address + 3);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  constexpr std::size_t longest = 160;
  if (text.size() > longest) text = text.substr(0, longest) + "...";
  return std::runtime_error(text);
}

char kind_of(itk::IOComponentEnum type) {
  using E = itk::IOComponentEnum;
  switch (type) {
    case E::UCHAR:
    case E::USHORT:
    case E::UINT:
    case E::ULONG:
    case E::ULONGLONG:
      return 'u';
    case E::CHAR:
    case E::SHORT:
    case E::INT:
    case E::LONG:
    case E::LONGLONG:
      return 'i';
    case E::FLOAT:
    case E::DOUBLE:
      return 'f';
    default:
      return '?';
  }
}

ItkVolume::Pixel pixel_of(itk::IOPixelEnum type) {
  using E = itk::IOPixelEnum;
  if (type == E::SCALAR) return ItkVolume::Pixel::scalar;
  if (type == E::RGB || type == E::RGBA) return ItkVolume::Pixel::rgb;
  return type == E::COMPLEX ? ItkVolume::Pixel::complex : ItkVolume::Pixel::other;
}

void read_all(itk::ImageIOBase& io, std::byte* buffer) {
  const QuietItk quiet;
  try {
    itk::ImageIORegion region(io.GetNumberOfDimensions());
    for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis) region.SetSize(axis, io.GetDimensions(axis));
    io.SetIORegion(region);
    io.Read(buffer);
  } catch (const itk::ExceptionObject& error) {
    throw one_line(error);
  }
}

}  // namespace

ItkVolume open_with_itk(const std::string& path, bool is_nrrd) {
  itk::ImageIOBase::Pointer io;
  if (is_nrrd)
    io = itk::NrrdImageIO::New();
  else
    io = itk::MetaImageIO::New();
  {
    const QuietItk quiet;
    try {
      io->SetFileName(path);
      io->ReadImageInformation();
    } catch (const itk::ExceptionObject& error) {
      throw one_line(error);
    }
  }
  ItkVolume volume;
  volume.pixel = pixel_of(io->GetPixelType());
  volume.components = io->GetNumberOfComponents();
  volume.kind = kind_of(io->GetComponentType());
  volume.bytes_per_component = io->GetComponentSize();
  const unsigned dimensions = io->GetNumberOfDimensions();
  for (unsigned axis = 0; axis < dimensions; ++axis) {
    volume.size.push_back(static_cast<std::int64_t>(io->GetDimensions(axis)));
    if (axis >= 3) continue;
    volume.spacing[axis] = io->GetSpacing(axis);
    volume.origin[axis] = io->GetOrigin(axis);
    const std::vector<double> direction = io->GetDirection(axis);
    std::copy_n(direction.begin(), std::min<std::size_t>(3, direction.size()), volume.direction[axis].begin());
  }
  volume.read = [io](std::byte* buffer) { read_all(*io, buffer); };
  return volume;
}

}  // namespace pellicle
