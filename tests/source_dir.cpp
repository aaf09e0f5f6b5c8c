#include "source_dir.h"

const char* pellicle_source_dir() {
  return PELLICLE_SOURCE_DIR_TEXT;
}
