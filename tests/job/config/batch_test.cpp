// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "job/config/batch_settings.hpp"

namespace millpose {

TEST(Batch, ReadsJobsWithTheirOverrides) {
  const BatchSettings batch = ParseBatch(
      "millpose_batch: 1\n"
      "jobs:\n"
      "  - {job: a/job.yaml}\n"
      "  - job: b.yaml\n"
      "    name: fine\n"
      "    set: {toolpath.stepover_mm: 4, programs: [krl], name: \"12\"}\n",
      "m.yaml");
  ASSERT_EQ(batch.jobs.size(), 2u);
  EXPECT_EQ(batch.jobs[0].job_file, "a/job.yaml");
  EXPECT_EQ(batch.jobs[0].name, "");
  EXPECT_EQ(batch.jobs[1].name, "fine");
  ASSERT_EQ(batch.jobs[1].overrides.size(), 3u);
  EXPECT_EQ(batch.jobs[1].overrides[0].path, "name");
  EXPECT_EQ(batch.jobs[1].overrides[0].value, "\"12\"") << "text stays text";
  EXPECT_EQ(batch.jobs[1].overrides[1].value, "[krl]");
  EXPECT_EQ(batch.jobs[1].overrides[2].value, "4");
}

TEST(Batch, SlipsAreNamedWithTheirPlace) {
  try {
    ParseBatch("millpose_batch: 1\njobs:\n  - {jb: a.yaml}\n", "m.yaml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "m.yaml:3:5: jobs[0].job: missing; required: text of one line\n"
                 "m.yaml:3:6: jobs[0].jb: unknown key; nearest known key: job");
  }
}

}  // namespace millpose
