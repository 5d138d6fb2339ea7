// jcas for C++17: classes that own the C handles, spans for buffers, and exceptions only on
// request.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
//
// Functions that can fail return jcas::status, or jcas::result<T>, which holds a value if it is ok.
// If JCAS_EXCEPTIONS is defined before this header, result<T>::take() and status::check() throw
// jcas::error instead of ending the program. Each file of a program may choose for itself.
//
//     auto model = jcas::model::create(jcas::configuration());
//     if (!model) { std::puts(model.message().c_str()); return 1; }
//     auto sim = jcas::sim::create(*model);
//     sim->reset(42);
//
// jcas.h documents each call. A model must outlive its simulations, batches and policies. A plan
// needs no model after it was made.
#ifndef JCAS_HPP
#define JCAS_HPP

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#ifdef JCAS_EXCEPTIONS
#include <stdexcept>
#endif

#include "jcas.h"

namespace jcas {

// Files with and without exceptions may be linked into one program: an inline namespace separates
// them.
#ifdef JCAS_EXCEPTIONS
inline namespace throwing {
#else
inline namespace plain {
#endif

/// A view of contiguous elements of the caller: a subset of C++20's std::span.
template <class T>
class span {
public:
    constexpr span() noexcept = default;
    constexpr span(T *data, std::size_t size) noexcept : data_(data), size_(size) {}
    template <std::size_t Count>
    constexpr span(T (&array)[Count]) noexcept : data_(array), size_(Count) {}
    /// Views any container with data() and size(). A temporary container can only be read.
    template <class Container,
              class = std::enable_if_t<
                  !std::is_same_v<std::decay_t<Container>, span> &&
                  (std::is_const_v<T> || std::is_lvalue_reference_v<Container>) &&
                  std::is_convertible_v<decltype(std::declval<Container &>().data()), T *>>>
    constexpr span(Container &&container) noexcept
        : data_(container.data()), size_(container.size())
    {
    }

    constexpr T *data() const noexcept { return data_; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr T &operator[](std::size_t index) const noexcept { return data_[index]; }
    constexpr T *begin() const noexcept { return data_; }
    constexpr T *end() const noexcept { return data_ + size_; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

#ifdef JCAS_EXCEPTIONS
/// The exception that check() and take() throw.
class error : public std::runtime_error {
public:
    error(std::int32_t code, const std::string &what) : std::runtime_error(what), code_(code) {}
    std::int32_t code() const noexcept { return code_; }

private:
    std::int32_t code_;
};
#endif

namespace detail {
[[noreturn]] inline void fail(std::int32_t code, const std::string &what)
{
#ifdef JCAS_EXCEPTIONS
    throw error(code, what);
#else
    std::fprintf(stderr, "jcas: %s (%d)\n", what.c_str(), static_cast<int>(code));
    std::abort();
#endif
}

/// Checks a call whose handle and sizes are valid. Only JCAS_ERROR_BUSY can refuse it: the object
/// is in use.
inline void certain(std::int32_t code)
{
    if (code != JCAS_OK)
        fail(code, jcas_status_string(code));
}

/// Returns a zeroed struct whose struct_size is set.
template <class Record>
Record sized()
{
    Record record;
    std::memset(&record, 0, sizeof record);
    record.struct_size = sizeof record;
    return record;
}

/// The sink of a trace and the working memory of its recording.
struct trace_sink {
    std::function<bool(std::string_view)> write;
    std::vector<std::uint64_t> memory;
    static std::int32_t take(const char *bytes, std::size_t count, void *context)
    {
        return static_cast<trace_sink *>(context)->write({bytes, count}) ? 0 : 1;
    }
};
} // namespace detail

/// The result of a call without a value.
class [[nodiscard]] status {
public:
    constexpr status(std::int32_t code) noexcept : code_(code) {}
    constexpr std::int32_t code() const noexcept { return code_; }
    constexpr explicit operator bool() const noexcept { return code_ == JCAS_OK; }
    const char *text() const noexcept { return jcas_status_string(code_); }
    /// Throws jcas::error, or ends the program, unless the call succeeded.
    void check() const
    {
        if (code_ != JCAS_OK)
            detail::fail(code_, text());
    }

private:
    std::int32_t code_;
};

/// A value, or the reason why there is none.
template <class T>
class [[nodiscard]] result {
public:
    result(T value) : value_(std::move(value)) {}
    result(std::int32_t code, std::string message = {}) : code_(code), message_(std::move(message))
    {
    }

    explicit operator bool() const noexcept { return value_.has_value(); }
    std::int32_t code() const noexcept { return code_; }
    /// The reason why there is no value, in English.
    std::string message() const { return message_.empty() ? jcas_status_string(code_) : message_; }
    /// The value. There must be one.
    T &operator*() noexcept { return *value_; }
    const T &operator*() const noexcept { return *value_; }
    T *operator->() noexcept { return &*value_; }
    const T *operator->() const noexcept { return &*value_; }
    /// Moves the value out. Throws jcas::error, or ends the program, if there is none.
    T take()
    {
        if (!value_)
            detail::fail(code_, message());
        return std::move(*value_);
    }

private:
    std::optional<T> value_;
    std::int32_t code_ = JCAS_OK;
    std::string message_;
};

/// Returns the default configuration, whose fields may then be changed.
inline jcas_config configuration()
{
    jcas_config config;
    detail::certain(jcas_config_default(&config, sizeof config));
    return config;
}

namespace detail {
using parser = std::int32_t(const char *, std::size_t, jcas_config *, std::size_t, char *,
                            std::size_t);

inline result<jcas_config> parse(parser *parse, std::string_view text)
{
    jcas_config config;
    char message[512] = "";
    const char *data = text.empty() ? "" : text.data();
    std::int32_t code = parse(data, text.size(), &config, sizeof config, message, sizeof message);
    if (code != JCAS_OK)
        return {code, message};
    return config;
}
} // namespace detail

inline result<jcas_config> preset(std::string_view name)
{
    return detail::parse(jcas_config_preset, name);
}
inline result<jcas_config> configuration_from_toml(std::string_view text)
{
    return detail::parse(jcas_config_from_toml, text);
}
inline result<jcas_config> configuration_from_json(std::string_view text)
{
    return detail::parse(jcas_config_from_json, text);
}

/// An owner of a jcas_model. Any number of threads may call const member functions at once.
class model {
public:
    static result<model> create(const jcas_config &config)
    {
        jcas_model *handle = nullptr;
        char message[512] = "";
        std::int32_t code = jcas_model_new(&config, &handle, message, sizeof message);
        if (code != JCAS_OK)
            return {code, message};
        return model(handle);
    }

    const jcas_model *get() const noexcept { return handle_.get(); }
    const jcas_model_info &info() const noexcept { return info_; }

    jcas_config config() const
    {
        jcas_config config;
        detail::certain(jcas_model_get_config(get(), &config, sizeof config));
        return config;
    }

    result<jcas_radio> radio(std::uint32_t dx, std::uint32_t dy, double pilot_density) const
    {
        auto radio = detail::sized<jcas_radio>();
        std::int32_t code = jcas_model_get_radio(get(), dx, dy, pilot_density, &radio);
        if (code != JCAS_OK)
            return {code};
        return radio;
    }

private:
    struct end {
        void operator()(jcas_model *handle) const noexcept { jcas_model_free(handle); }
    };
    explicit model(jcas_model *handle) : handle_(handle), info_(detail::sized<jcas_model_info>())
    {
        detail::certain(jcas_model_get_info(handle, &info_));
    }
    std::unique_ptr<jcas_model, end> handle_;
    jcas_model_info info_;
};

/// An owner of a jcas_sim. One thread at a time may use it: a call that finds it in use returns
/// JCAS_ERROR_BUSY. A query without a status then fails as status::check() does.
class sim {
public:
    static result<sim> create(const model &model)
    {
        jcas_sim *handle = nullptr;
        std::int32_t code = jcas_sim_new(model.get(), &handle);
        if (code != JCAS_OK)
            return {code};
        return sim(handle, model);
    }

    jcas_sim *get() noexcept { return handle_.get(); }
    const jcas_sim *get() const noexcept { return handle_.get(); }
    const jcas_model_info &info() const noexcept { return info_; }

    status reset(std::uint64_t seed) { return jcas_sim_reset(get(), seed); }

    result<jcas_outcome> step(span<const float> actions)
    {
        auto outcome = detail::sized<jcas_outcome>();
        std::int32_t code = jcas_sim_step(get(), actions.data(), actions.size(), &outcome);
        if (code != JCAS_OK)
            return {code, message(code)};
        return outcome;
    }

    status step_begin(span<const float> actions)
    {
        return jcas_sim_step_begin(get(), actions.data(), actions.size());
    }
    status set_positions(span<const jcas_cell> cells)
    {
        return jcas_sim_set_positions(get(), cells.data(), cells.size());
    }
    status ground(std::uint32_t uav) { return jcas_sim_ground(get(), uav); }
    status confirm_hotspot(std::uint32_t hotspot)
    {
        return jcas_sim_confirm_hotspot(get(), hotspot);
    }
    status step_sense() { return jcas_sim_step_sense(get()); }
    status step_sense_with(span<const std::uint8_t> detections)
    {
        return jcas_sim_step_sense_with(get(), detections.data(), detections.size());
    }
    status step_communicate() { return jcas_sim_step_communicate(get()); }
    status step_communicate_with(span<const std::uint8_t> links, span<const double> throughput = {})
    {
        return jcas_sim_step_communicate_with(get(), links.data(), links.size(), throughput.data(),
                                              throughput.size());
    }
    result<jcas_outcome> step_end()
    {
        auto outcome = detail::sized<jcas_outcome>();
        std::int32_t code = jcas_sim_step_end(get(), &outcome);
        if (code != JCAS_OK)
            return {code, message(code)};
        return outcome;
    }
    status set_hotspots(span<const jcas_cell> cells)
    {
        return jcas_sim_set_hotspots(get(), cells.data(), cells.size());
    }
    status set_batteries(span<const std::uint64_t> charges_uj)
    {
        return jcas_sim_set_batteries(get(), charges_uj.data(), charges_uj.size());
    }

    status set_starts(span<const jcas_cell> cells)
    {
        return jcas_sim_set_starts(get(), cells.data(), cells.size());
    }
    status set_battery(std::uint32_t uav, std::uint64_t charge_uj)
    {
        return jcas_sim_set_battery(get(), uav, charge_uj);
    }
    status move_hotspot(std::uint32_t hotspot, jcas_cell to)
    {
        return jcas_sim_move_hotspot(get(), hotspot, to.x, to.y);
    }
    status detections(span<std::uint8_t> out) const
    {
        return jcas_sim_get_detections(get(), out.data(), out.size());
    }
    status throughputs(span<double> out) const
    {
        return jcas_sim_get_throughputs(get(), out.data(), out.size());
    }

    status observe(span<float> out) { return jcas_sim_observe(get(), out.data(), out.size()); }
    status observe_global(span<float> out) const
    {
        return jcas_sim_observe_global(get(), out.data(), out.size());
    }

    jcas_episode episode() const
    {
        auto episode = detail::sized<jcas_episode>();
        detail::certain(jcas_sim_get_episode(get(), &episode));
        return episode;
    }
    jcas_metrics metrics() const
    {
        auto metrics = detail::sized<jcas_metrics>();
        detail::certain(jcas_sim_get_metrics(get(), &metrics));
        return metrics;
    }
    std::vector<double> rewards() const
    {
        std::vector<double> rewards(info_.reward_len);
        detail::certain(jcas_sim_get_rewards(get(), rewards.data(), rewards.size()));
        return rewards;
    }
    /// The reward of each UAV, whose mean is the team reward.
    std::vector<double> uav_rewards() const
    {
        std::vector<double> rewards(info_.uav_count);
        detail::certain(jcas_sim_uav_rewards(get(), rewards.data(), rewards.size()));
        return rewards;
    }
    /// Writes the UAVs to a buffer of uav_count elements, without an allocation.
    status uavs(span<jcas_uav> out) const
    {
        return jcas_sim_get_uavs(get(), out.data(), out.size(), sizeof(jcas_uav));
    }
    std::vector<jcas_uav> uavs() const
    {
        std::vector<jcas_uav> all(info_.uav_count);
        detail::certain(jcas_sim_get_uavs(get(), all.data(), all.size(), sizeof(jcas_uav)));
        return all;
    }
    /// Writes the hotspots to a buffer of hotspot_count elements, without an allocation.
    status hotspots(span<jcas_hotspot> out) const
    {
        return jcas_sim_get_hotspots(get(), out.data(), out.size(), sizeof(jcas_hotspot));
    }
    std::vector<jcas_hotspot> hotspots() const
    {
        std::vector<jcas_hotspot> all(info_.hotspot_count);
        detail::certain(jcas_sim_get_hotspots(get(), all.data(), all.size(), sizeof(jcas_hotspot)));
        return all;
    }
    status links(span<std::uint8_t> out) const
    {
        return jcas_sim_get_links(get(), out.data(), out.size());
    }
    status knowledge(span<std::uint8_t> out) const
    {
        return jcas_sim_get_knowledge(get(), out.data(), out.size());
    }
    status visited(span<std::uint8_t> out) const
    {
        return jcas_sim_get_visited(get(), out.data(), out.size());
    }
    status false_alarms(span<std::uint8_t> out) const
    {
        return jcas_sim_get_false_alarms(get(), out.data(), out.size());
    }
    status false_confirmations(span<std::uint8_t> out) const
    {
        return jcas_sim_get_false_confirmations(get(), out.data(), out.size());
    }
    status reports(span<std::uint8_t> out) const
    {
        return jcas_sim_get_reports(get(), out.data(), out.size());
    }

    std::vector<unsigned char> save() const
    {
        std::vector<unsigned char> snapshot(info_.snapshot_size);
        detail::certain(jcas_sim_save(get(), snapshot.data(), snapshot.size()));
        return snapshot;
    }
    status load(span<const unsigned char> snapshot)
    {
        return jcas_sim_load(get(), snapshot.data(), snapshot.size());
    }
    /// Copies the state of another simulation. The two are then independent.
    status fork_from(const sim &other) { return jcas_sim_fork(other.get(), get()); }
    std::uint64_t hash() const
    {
        std::uint64_t hash = 0;
        detail::certain(jcas_sim_hash(get(), &hash));
        return hash;
    }
    /// Begins the episode of a seed, as reset does, and records it. `write` takes each piece of the
    /// trace and returns false to refuse it. It must not throw.
    status record(std::uint64_t seed, std::function<bool(std::string_view)> write,
                  const std::string &policy = "host", const std::string &pilot = "host")
    {
        std::size_t size = 0, alignment = 0;
        detail::certain(jcas_trace_layout(model_, &size, &alignment));
        auto sink = std::make_unique<detail::trace_sink>();
        sink->write = std::move(write);
        sink->memory.resize(size / sizeof(std::uint64_t));
        auto recorder = detail::sized<jcas_recorder>();
        recorder.write = detail::trace_sink::take, recorder.write_context = sink.get();
        recorder.policy = policy.c_str(), recorder.pilot = pilot.c_str();
        recorder.memory = sink->memory.data(), recorder.memory_size = size;
        const std::int32_t code = jcas_sim_record(get(), seed, &recorder);
        if (code == JCAS_OK)
            trace_sink_ = std::move(sink);
        return code;
    }
    status record_end() { return jcas_sim_record_end(get()); }
    /// Repeats a trace, compares it with its file and returns the hash of the last state; see
    /// jcas_trace_verify.
    result<std::uint64_t> verify(std::string_view trace)
    {
        std::size_t size = 0, alignment = 0;
        detail::certain(jcas_trace_layout(model_, &size, &alignment));
        std::vector<std::uint64_t> memory(size / sizeof(std::uint64_t));
        char message[512] = "";
        const std::int32_t code = jcas_trace_verify(get(), memory.data(), size, trace.data(),
                                                    trace.size(), message, sizeof message);
        if (code != JCAS_OK)
            return {code, message};
        return hash();
    }
    /// The reason why the last call was refused; empty if it succeeded.
    std::string message() const
    {
        char text[512] = "";
        std::size_t length = 0;
        detail::certain(jcas_sim_message(get(), text, sizeof text, &length));
        return text;
    }

private:
    struct end {
        void operator()(jcas_sim *handle) const noexcept { jcas_sim_free(handle); }
    };
    /// The reason why a call was refused. A simulation keeps none for a call that found it in use.
    std::string message(std::int32_t code) const
    {
        return code == JCAS_ERROR_BUSY ? jcas_status_string(code) : message();
    }
    sim(jcas_sim *handle, const model &model)
        : handle_(handle), model_(model.get()), info_(model.info())
    {
    }
    std::unique_ptr<detail::trace_sink> trace_sink_; // outlives the handle that writes to it
    std::unique_ptr<jcas_sim, end> handle_;
    const jcas_model *model_;
    jcas_model_info info_;
};

/// What the environments of a batch made in a rollout; see jcas_rollout_out.
struct futures {
    explicit futures(std::size_t environments)
        : returns(environments), steps(environments), terminated(environments),
          truncated(environments), metrics(environments)
    {
    }

    std::vector<double> returns;
    std::vector<std::uint32_t> steps;
    std::vector<std::uint8_t> terminated;
    std::vector<std::uint8_t> truncated;
    std::vector<jcas_metrics> metrics;

    /// The addresses and lengths as the C interface takes them.
    jcas_rollout_out buffers() noexcept
    {
        auto out = detail::sized<jcas_rollout_out>();
        out.returns = returns.data();
        out.return_count = returns.size();
        out.steps = steps.data();
        out.step_count = steps.size();
        out.terminated = terminated.data();
        out.terminated_count = terminated.size();
        out.truncated = truncated.data();
        out.truncated_count = truncated.size();
        out.metrics = metrics.data();
        out.metrics_count = metrics.size();
        out.metrics_size = sizeof(jcas_metrics);
        return out;
    }
};

/// An owner of a jcas_batch and of the buffers that its steps write. One thread at a time may use
/// it.
class batch {
public:
    /// `threads` counts the caller's thread; 0 means one for each processor.
    static result<batch> create(const model &model, std::uint32_t environments,
                                std::uint32_t threads = 1)
    {
        jcas_batch *handle = nullptr;
        std::int32_t code = jcas_batch_new(model.get(), environments, threads, &handle);
        if (code != JCAS_OK)
            return {code};
        return batch(handle, model, environments);
    }

    jcas_batch *get() noexcept { return handle_.get(); }
    const jcas_batch *get() const noexcept { return handle_.get(); }
    std::size_t environments() const noexcept { return rewards.size(); }

    status reset(span<const std::uint64_t> seeds)
    {
        return jcas_batch_reset(get(), seeds.data(), seeds.size(), observations.data(),
                                observations.size(), global.data(), global.size());
    }

    status step(span<const float> actions, bool auto_reset = true)
    {
        const jcas_batch_out out = buffers();
        return jcas_batch_step(get(), actions.data(), actions.size(), auto_reset ? 1 : 0, &out);
    }

    /// Resets only the environments whose mask is not 0.
    status reset_some(span<const std::uint8_t> mask, span<const std::uint64_t> seeds)
    {
        return jcas_batch_reset_some(get(), mask.data(), mask.size(), seeds.data(), seeds.size(),
                                     observations.data(), observations.size(), global.data(),
                                     global.size());
    }

    /// Saves all environments into environments() * snapshot_size bytes.
    status save(span<unsigned char> out) const
    {
        return jcas_batch_save(get(), out.data(), out.size());
    }
    status load(span<const unsigned char> saved)
    {
        return jcas_batch_load(get(), saved.data(), saved.size());
    }
    std::uint64_t hash() const
    {
        std::uint64_t hash = 0;
        detail::certain(jcas_batch_hash(get(), &hash));
        return hash;
    }

    status copy_to(std::uint32_t index, sim &to) const
    {
        return jcas_batch_get(get(), index, to.get());
    }
    status copy_from(std::uint32_t index, const sim &from)
    {
        return jcas_batch_set(get(), index, from.get());
    }

    /// Copies a simulation into every environment; see jcas_batch_fork.
    status fork(const sim &from, span<const std::uint64_t> seeds = {})
    {
        return jcas_batch_fork(get(), from.get(), nullptr, seeds.data(), seeds.size());
    }

    /// Steps every environment by given actions; see jcas_batch_rollout.
    status roll_out(span<const float> actions, std::uint32_t steps, futures &into)
    {
        const jcas_rollout_out out = into.buffers();
        return jcas_batch_rollout(get(), nullptr, actions.data(), actions.size(), steps, &out);
    }

    // Generated from jcas_batch_out by ffi/examples/generate_header.rs; do not edit.
    /// The buffers that reset and step write; see jcas_batch_out for their shapes.
    std::vector<float> observations;
    std::vector<float> rewards;
    std::vector<std::uint8_t> terminated;
    std::vector<std::uint8_t> truncated;
    std::vector<float> global;
    std::vector<double> components;
    std::vector<float> final_observations;
    std::vector<float> final_global;
    std::vector<jcas_metrics> final_metrics;
    std::vector<float> uav_rewards;

private:
    jcas_batch_out buffers() noexcept
    {
        auto out = detail::sized<jcas_batch_out>();
        out.observations = observations.data();
        out.observation_count = observations.size();
        out.rewards = rewards.data();
        out.reward_count = rewards.size();
        out.terminated = terminated.data();
        out.terminated_count = terminated.size();
        out.truncated = truncated.data();
        out.truncated_count = truncated.size();
        out.global = global.data();
        out.global_count = global.size();
        out.components = components.data();
        out.component_count = components.size();
        out.final_observations = final_observations.data();
        out.final_observation_count = final_observations.size();
        out.final_global = final_global.data();
        out.final_global_count = final_global.size();
        out.final_metrics = final_metrics.data();
        out.final_metrics_count = final_metrics.size();
        out.metrics_size = sizeof(jcas_metrics);
        out.uav_rewards = uav_rewards.data();
        out.uav_reward_count = uav_rewards.size();
        return out;
    }
    // End of the generated part.

    struct end {
        void operator()(jcas_batch *handle) const noexcept { jcas_batch_free(handle); }
    };
    batch(jcas_batch *handle, const model &model, std::size_t count)
        : observations(count * model.info().uav_count * model.info().observation_len),
          rewards(count), terminated(count), truncated(count),
          global(count * model.info().global_len), components(count * model.info().reward_len),
          final_observations(observations.size()), final_global(global.size()),
          final_metrics(count), uav_rewards(count * model.info().uav_count), handle_(handle)
    {
    }
    std::unique_ptr<jcas_batch, end> handle_;
};

/// An owner of a jcas_plan: the cell and the pilot density of each UAV in each step. It never
/// changes. Any number of threads may call const member functions at once.
class plan {
public:
    /// Hears of the progress: the moves tried so far, and the expected steps of the best plan so
    /// far. It returns false to end the annealing early. It must not throw.
    using progress = std::function<bool(std::uint64_t, double)>;

    /// Plans for hidden hotspots; see jcas_plan_search.
    static result<plan> search(const model &model, std::uint64_t iterations, std::uint64_t seed = 1,
                               progress tell = {})
    {
        const jcas_plan_settings settings = settings_of(iterations, seed, tell);
        jcas_plan *handle = nullptr;
        char message[512] = "";
        std::int32_t code =
            jcas_plan_search(model.get(), &settings, &handle, message, sizeof message);
        return made(code, handle, message);
    }

    /// Plans for hotspots in known cells; see jcas_plan_tour.
    static result<plan> tour(const model &model, span<const jcas_cell> hotspots,
                             std::uint64_t iterations, std::uint64_t seed = 1, progress tell = {})
    {
        const jcas_plan_settings settings = settings_of(iterations, seed, tell);
        jcas_plan *handle = nullptr;
        char message[512] = "";
        std::int32_t code = jcas_plan_tour(model.get(), hotspots.data(), hotspots.size(), &settings,
                                           &handle, message, sizeof message);
        return made(code, handle, message);
    }

    /// Reads a plan from its text.
    static result<plan> from_json(const model &model, std::string_view text)
    {
        jcas_plan *handle = nullptr;
        char message[512] = "";
        const char *data = text.empty() ? "" : text.data();
        std::int32_t code =
            jcas_plan_from_json(model.get(), data, text.size(), &handle, message, sizeof message);
        return made(code, handle, message);
    }

    const jcas_plan *get() const noexcept { return handle_.get(); }
    const jcas_plan_info &info() const noexcept { return info_; }

    std::string to_json() const
    {
        std::size_t length = 0;
        detail::certain(jcas_plan_to_json(get(), nullptr, 0, &length));
        std::string text(length + 1, '\0');
        detail::certain(jcas_plan_to_json(get(), text.data(), text.size(), &length));
        text.resize(length);
        return text;
    }

    /// The cell of each UAV before the first step, then after each step: step_count + 1 for a UAV.
    std::vector<jcas_cell> cells() const
    {
        std::vector<jcas_cell> cells(std::size_t{info_.uav_count} * (info_.step_count + 1));
        detail::certain(jcas_plan_get_cells(get(), cells.data(), cells.size()));
        return cells;
    }

    /// The pilot density of each UAV in each step: step_count for a UAV.
    std::vector<double> pilot_densities() const
    {
        std::vector<double> densities(std::size_t{info_.uav_count} * info_.step_count);
        detail::certain(jcas_plan_get_pilot_densities(get(), densities.data(), densities.size()));
        return densities;
    }

private:
    struct end {
        void operator()(jcas_plan *handle) const noexcept { jcas_plan_free(handle); }
    };
    static std::int32_t tell_of(std::uint64_t iterations, double best_steps, void *context)
    {
        return (*static_cast<progress *>(context))(iterations, best_steps) ? 0 : 1;
    }
    static jcas_plan_settings settings_of(std::uint64_t iterations, std::uint64_t seed,
                                          progress &tell)
    {
        auto settings = detail::sized<jcas_plan_settings>();
        settings.iterations = iterations, settings.seed = seed;
        settings.progress = tell ? tell_of : nullptr, settings.progress_context = &tell;
        return settings;
    }
    static result<plan> made(std::int32_t code, jcas_plan *handle, const char *message)
    {
        if (code != JCAS_OK)
            return {code, message};
        return plan(handle);
    }
    explicit plan(jcas_plan *handle) : handle_(handle), info_(detail::sized<jcas_plan_info>())
    {
        detail::certain(jcas_plan_get_info(handle, &info_));
    }
    std::unique_ptr<jcas_plan, end> handle_;
    jcas_plan_info info_;
};

/// An owner of a jcas_policy, which controls a fleet. One thread at a time may use it.
class policy {
public:
    /// Loads a trained network from the bytes of its file.
    static result<policy> load(const model &model, span<const std::uint8_t> file)
    {
        jcas_policy *handle = nullptr;
        char message[512] = "";
        const std::uint8_t none = 0;
        const std::uint8_t *data = file.size() > 0 ? file.data() : &none;
        std::int32_t code =
            jcas_policy_load(model.get(), data, file.size(), &handle, message, sizeof message);
        if (code != JCAS_OK)
            return {code, message};
        return policy(handle);
    }

    /// Builds a baseline by its name; `pilot` is as for jcas_policy_baseline.
    static result<policy> baseline(const model &model, const std::string &name,
                                   const std::string &pilot = "adaptive")
    {
        jcas_policy *handle = nullptr;
        char message[512] = "";
        std::int32_t code = jcas_policy_baseline(model.get(), name.c_str(), pilot.c_str(), &handle,
                                                 message, sizeof message);
        if (code != JCAS_OK)
            return {code, message};
        return policy(handle);
    }

    /// Builds the policy that follows a plan, which is not needed any more then.
    static result<policy> follow(const model &model, const plan &plan)
    {
        jcas_policy *handle = nullptr;
        std::int32_t code = jcas_policy_follow(model.get(), plan.get(), &handle);
        if (code != JCAS_OK)
            return {code};
        return policy(handle);
    }

    jcas_policy *get() noexcept { return handle_.get(); }

    /// Draws a network's actions from its distribution if `sampled`, else takes the most likely
    /// ones.
    status sampled(bool sampled)
    {
        return jcas_policy_set_mode(get(),
                                    sampled ? JCAS_POLICY_SAMPLED : JCAS_POLICY_DETERMINISTIC);
    }

    status act(const sim &sim, span<float> actions)
    {
        return jcas_policy_act(get(), sim.get(), actions.data(), actions.size());
    }
    status act(const batch &batch, span<float> actions)
    {
        return jcas_policy_act_batch(get(), batch.get(), actions.data(), actions.size());
    }

    /// Saves what the policy remembers of the simulation that it acts for.
    result<std::vector<unsigned char>> save_memory(const sim &sim)
    {
        std::size_t length = 0;
        std::int32_t code = jcas_policy_memory_save(get(), sim.get(), nullptr, 0, &length);
        std::vector<unsigned char> memory(code == JCAS_OK ? length : 0);
        if (code == JCAS_OK)
            code = jcas_policy_memory_save(get(), sim.get(), memory.data(), length, &length);
        if (code != JCAS_OK)
            return {code};
        return memory;
    }

    /// Copies a simulation, and what this policy remembers of it, into every environment of a
    /// batch; see jcas_batch_fork.
    status fork(const sim &from, batch &into, span<const std::uint64_t> seeds = {})
    {
        return jcas_batch_fork(into.get(), from.get(), get(), seeds.data(), seeds.size());
    }

    /// Steps every environment of a batch by this policy; see jcas_batch_rollout.
    status roll_out(batch &batch, std::uint32_t steps, futures &into)
    {
        const jcas_rollout_out out = into.buffers();
        return jcas_batch_rollout(batch.get(), get(), nullptr, 0, steps, &out);
    }

    /// Loads what an equal policy remembered in the state of this simulation.
    status load_memory(const sim &sim, span<const unsigned char> memory)
    {
        return jcas_policy_memory_load(get(), sim.get(), memory.data(), memory.size());
    }

    /// Forgets everything: the policy begins anew in the next state that it acts in.
    status forget() { return jcas_policy_forget(get()); }

private:
    struct end {
        void operator()(jcas_policy *handle) const noexcept { jcas_policy_free(handle); }
    };
    explicit policy(jcas_policy *handle) : handle_(handle) {}
    std::unique_ptr<jcas_policy, end> handle_;
};

/// Checks that the library that runs serves a program compiled with this header.
inline status check_abi() { return jcas_abi_check(JCAS_ABI_VERSION); }

} // namespace throwing or plain
} // namespace jcas

#endif // JCAS_HPP
