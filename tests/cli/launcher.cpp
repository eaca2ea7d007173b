// Tests of the launcher, which becomes the program of a command's family and sets how long its
// threads spin.
#include "tests/support/program.h"

namespace item3d::testing {
namespace {

class Launcher : public Program {
  protected:
    /// Returns GOMP_SPINCOUNT as the launcher passes it to a stand-in for item3d-edit.
    std::string spin_count(const std::string& variables) const {
        const fs::path launcher = folder_ / "item3d", commands = folder_ / "item3d-edit";
        fs::copy_file(ITEM3D_PROGRAM, launcher, fs::copy_options::overwrite_existing);
        std::ofstream(commands) << "#!/bin/sh\necho \"${GOMP_SPINCOUNT-none} $*\"\n";
        fs::permissions(commands, fs::perms::owner_all);
        const fs::path out = folder_ / "stdout";
        const std::string command = "env -u GOMP_SPINCOUNT -u OMP_WAIT_POLICY " + variables + " " +
                                    quoted(launcher) + " edit 'a b' >" + quoted(out);
        EXPECT_EQ(std::system(command.c_str()), 0);
        return read_file(out);
    }
};

TEST_F(Launcher, ThreadsWaitBriefly) {
    EXPECT_EQ(spin_count(""), "5000 edit a b\n");
}

TEST_F(Launcher, WaitingIsAsTheCallerSays) {
    EXPECT_EQ(spin_count("GOMP_SPINCOUNT=5"), "5 edit a b\n");
    EXPECT_EQ(spin_count("OMP_WAIT_POLICY=active"), "none edit a b\n");
}

}  // namespace
}  // namespace item3d::testing
