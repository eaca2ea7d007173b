// Tests of the guarantee in docs/method.md: on processors of Intel, an edit gives the same bytes
// for any number of threads.
#include "item3d/core/files.h"
#include "tests/support/edit.h"

#include <ATen/Parallel.h>
#include <omp.h>

#include <cstdlib>

namespace item3d::testing {
namespace {

class Threads : public EditTest {
  protected:
    void SetUp() override {
        EditTest::SetUp();
        before_ = omp_get_max_threads();
    }
    void TearDown() override {
        use(before_);
        EditTest::TearDown();
    }

    static void use(int threads) {
        omp_set_num_threads(threads);
        at::set_num_threads(threads);
    }

    /// Edits with the embedded prior. Returns model.glb and the state that it was baked from.
    std::string edited_on(int threads) const {
        use(threads);
        EditRequest edit =
            request(std::to_string(threads), 2, {{"to", "a golden cube"}, {"batch", 4}});
        const char* assets = std::getenv("ITEM3D_ASSETS");
        edit.prior = fs::path(assets ? assets : "assets") / "prior";
        change(edit, {{"resolution", 64},
                      {"light_augment", "all"},
                      {"detail", "always"},
                      {"detail_views", 1}});
        edit_model(edit);
        return read_text(edit.output / "model.glb") +
               read_text(edit.output / "checkpoint.safetensors");
    }

  private:
    int before_ = 1;
};

TEST_F(Threads, GiveTheSameBytesHoweverMany) {
    __builtin_cpu_init();
    if (!__builtin_cpu_is("intel"))
        GTEST_SKIP() << "MKL's strict mode has an effect on processors of Intel only";
    const std::string one = edited_on(1);
    EXPECT_TRUE(edited_on(3) == one) << "three threads";
}

}  // namespace
}  // namespace item3d::testing
