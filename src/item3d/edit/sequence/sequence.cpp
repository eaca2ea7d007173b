#include "item3d/edit/sequence/sequence.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/core/stage_times.h"
#include "item3d/core/version.h"
#include "item3d/edit/edit.h"
#include "item3d/edit/outputs/baked_files.h"
#include "item3d/edit/sequence/region_check.h"
#include "item3d/edit/sequence/sequence_page.h"
#include "item3d/edit/sequence/sequence_state.h"
#include "item3d/io/load.h"
#include "item3d/io/overwrite.h"
#include "item3d/tensors/checkpoint.h"

#include <span>
#include <utility>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class SequenceRun {
  public:
    explicit SequenceRun(const EditSequence& sequence)
        : sequence_(sequence),
          output_(sequence.output),
          edits_(sequence.edits),
          session_(sequence.edits),
          state_(sequence.output / "plan_state.json", sequence.resume),
          prior_weights_(session_.prior_hash(edits_.front().prior)) {
        fs::path model = sequence.model;
        for (std::size_t i = 0; i < edits_.size(); ++i) {
            EditRequest& edit = edits_[i];
            edit.model = model;
            edit.output = sequence.output / std::to_string(i + 1);
            edit.checkpoint = sequence.output / "checkpoint.safetensors";
            edit.draws_turntable = i + 1 == edits_.size();
            model = result_of(edit);
        }
    }

    json run() {
        std::size_t next = 0;
        while (next < edits_.size() && is_there(next)) {
            note(fmt::format("edit {} of {} already exists", next + 1, edits_.size()));
            ++next;
        }
        if (next < edits_.size()) look_ahead();
        for (; next < edits_.size(); ++next)
            make(next);
        return conclude();
    }

  private:
    static fs::path result_of(const EditRequest& edit) {
        return edit.output / model_file_name(edit.model);
    }
    static fs::path record_of(const EditRequest& edit) { return edit.output / "edit.json"; }

    json question(std::size_t index) {
        json asked = question_of(edits_[index], prior_weights_.get());
        // The models of later edits follow from the first edit's model.
        if (index == 0) asked["model"] = hash_of_file(sequence_.model);
        return asked;
    }

    bool is_there(std::size_t index) {
        const EditRequest& edit = edits_[index];
        return state_.is_done(index, question(index)) && fs::exists(result_of(edit)) &&
               fs::exists(record_of(edit)) &&
               (!edit.draws_turntable || fs::exists(edit.output / "turntable.webp"));
    }

    /// Checks everything that can be checked before the first edit starts.
    void look_ahead() {
        const auto load = [&](const EditRequest& edit) {
            return load_model(sequence_.model, {.texture_folders = edit.texture_folders,
                                                .variant = edit.plan.variant});
        };
        const std::string& variant = edits_.front().plan.variant;
        Model model = load(edits_.front());
        for (std::size_t i = 0; i < edits_.size(); ++i) {
            try {
                if (edits_[i].plan.variant != variant) load(edits_[i]);
                session_.lights(edits_[i].plan, edits_[i].device);
            } catch (const InputError& error) {
                throw InputError(edit_name(sequence_.plan, i), error.what());
            }
        }
        check_regions(sequence_.plan, edits_, model);
        session_.keep_groups(model);
        session_.keep_model(sequence_.model, variant, std::move(model));
    }

    void make(std::size_t index) {
        EditRequest& edit = edits_[index];
        const json asked = question(index);
        edit.resume = state_.is_begun(index, asked);
        if (!edit.resume) fs::remove(edit.checkpoint);
        note(fmt::format("edit {} of {}: {} -> {}", index + 1, edits_.size(), edit.plan.from,
                         edit.plan.to));
        fs::remove(record_of(edit));
        state_.begin(index, asked);
        try {
            edit_model(edit, session_);
        } catch (const InputError& error) {
            throw InputError(edit_name(sequence_.plan, index), error.what());
        } catch (const Interrupted& stop) {
            throw Interrupted(
                fmt::format("edit {} of {}: {}", index + 1, edits_.size(), stop.what()));
        }
        state_.finish(index);
        fs::remove(edit.checkpoint);
    }

    json conclude() {
        json record{{"version", version()},
                    {"command", edits_.front().command},
                    {"model", sequence_.model.string()},
                    {"edits", json::array()}};
        for (const EditRequest& edit : edits_)
            record["edits"].push_back(parse_json_or_throw(read_text(record_of(edit))));
        record["seconds"] = {{"total", times_.total()}};
        const fs::path result = result_of(edits_.back());
        const Bytes bytes = read_bytes(result);
        write_atomically(sequence_.output / result.filename(),
                         std::span<const std::uint8_t>(bytes));
        write_atomically(sequence_.output / "report.html",
                         std::string_view(sequence_page(record, edits_)));
        write_atomically(sequence_.output / "edit.json", std::string_view(record.dump(2) + "\n"));
        return record;
    }

    const EditSequence& sequence_;
    StageTimes times_;
    OutputFolder output_;
    std::vector<EditRequest> edits_;
    EditSession session_;
    SequenceState state_;
    std::shared_future<std::string> prior_weights_;
};

}  // namespace

nlohmann::json edit_in_sequence(const EditSequence& sequence) {
    check_not_replaced(sequence.model, sequence.output / model_file_name(sequence.model));
    return SequenceRun(sequence).run();
}

}  // namespace item3d
