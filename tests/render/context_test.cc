// Each source of OpenGL in a process of its own: the first choice holds for the whole process.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "tests/support/paths.h"

namespace {

struct Answer {
  int status = -1;
  std::string text;  // of both streams
};

Answer run(const std::string& environment) {
  Answer answer;
  // a leak checker's words about suppressed leaks are no answer
  FILE* pipe = popen(("LSAN_OPTIONS=print_suppressions=0 " + environment + " '" +
                      lab::build_path("bin/render_hash") + "' 2>&1")
                         .c_str(),
                     "r");
  if (!pipe) return answer;
  for (char part[256]; std::fgets(part, sizeof part, pipe);) answer.text += part;
  answer.status = pclose(pipe);
  return answer;
}

TEST(Context, OsmesaAndEglDrawTheSamePicture) {
  const Answer osmesa = run("LAB_GL=osmesa"), egl = run("LAB_GL=egl"), any = run("LAB_GL=");
  ASSERT_EQ(egl.status, 0) << egl.text;
  const size_t name = egl.text.find(" EGL, ");
  ASSERT_NE(name, std::string::npos) << egl.text;
  if (osmesa.text.find("libOSMesa") != std::string::npos) GTEST_SKIP() << "OSMesa is not installed";
  ASSERT_EQ(osmesa.status, 0) << osmesa.text;
  EXPECT_EQ(any.text, osmesa.text) << "OSMesa is the first choice";
  EXPECT_NE(osmesa.text.find(" OSMesa, "), std::string::npos) << osmesa.text;
  // one Mesa, one rasterizer: the same bytes (with a GPU, EGL takes that, and draws in its own way)
  if (osmesa.text.find(egl.text.substr(name + 6)) != std::string::npos) {
    EXPECT_EQ(egl.text.substr(0, 16), osmesa.text.substr(0, 16));
  }
}

TEST(Context, WithoutOsmesaEglDraws) {
  const std::string hidden = "LD_LIBRARY_PATH='" + lab::build_path("tests/render/no_osmesa") + "' ";
  const Answer any = run(hidden + "LAB_GL="), egl = run("LAB_GL=egl"), none = run(hidden + "LAB_GL=osmesa");
  EXPECT_EQ(any.status, 0);
  EXPECT_EQ(any.text, egl.text);
  EXPECT_NE(none.status, 0);
  EXPECT_NE(none.text.find("libOSMesa"), std::string::npos) << none.text;
}

TEST(Context, ImpossibleWishesAreOneClearLine) {
  const Answer unknown = run("LAB_GL=metal");
  EXPECT_NE(unknown.status, 0);
  EXPECT_EQ(unknown.text, "LAB_GL must be osmesa or egl, not 'metal'\n");
  // A vendor list without a vendor: libEGL is there but leads nowhere.
  const Answer nobody = run("LAB_GL=egl __EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent");
  EXPECT_NE(nobody.status, 0);
  EXPECT_EQ(nobody.text.find("no OpenGL without a screen (install "), 0u) << nobody.text;
  EXPECT_NE(nobody.text.find("EGL: gives no display"), std::string::npos) << nobody.text;
  EXPECT_EQ(nobody.text.find('\n'), nobody.text.size() - 1) << nobody.text;
}

}  // namespace
