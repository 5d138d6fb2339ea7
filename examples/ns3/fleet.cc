// jcas inside ns-3. ns-3 moves the UAVs, and its Wi-Fi determines the links. jcas, through its C
// interface, does sensing, consensus, energy, carbon and reward.
//
// A policy of jcas decides each UAV's motion and pilot density. It is a trained network from a
// file, or a baseline by its name. In each step of 10 s every UAV broadcasts one beacon over ad-hoc
// 802.11a near the end of the step. Two UAVs are linked in that step if each heard the other.
//
// The same mission is flown twice by the same policy: once over the links that Wi-Fi made, once
// over those of jcas's own link budget.
//
//     ./fleet [--policy=greedy] [--uavs=10] [--hotspots=4] [--seed=3] [--exponent=3]
//     ./fleet --policy=../../policies/mission/policy.safetensors --trace=flight.jsonl
//     ./fleet --preset=search --policy=line --uavs=15 --hotspots=7 --exponent=3.5
//
// With --trace the mission over Wi-Fi is recorded, with the positions and links that ns-3 supplied.
// `jcas trace verify flight.jsonl` replays it without ns-3. `jcas replay flight.jsonl` shows it.
#include <jcas.hpp>

#include "ns3/constant-velocity-mobility-model.h"
#include "ns3/core-module.h"
#include "ns3/mobility-module.h"
#include "ns3/network-module.h"
#include "ns3/wifi-module.h"
#include "ns3/yans-wifi-helper.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

constexpr double STEP_S = 10;
constexpr double BEACON_AT_S = 9;
constexpr double BEACON_SPACING_S = 0.01;
constexpr std::uint16_t PROTOCOL = 0x88b5; // IEEE 802, local experiments
constexpr std::uint32_t BEACON_BYTES = 64;

struct Options {
    std::string preset = "mission";
    std::string policy = "greedy";
    std::uint32_t uavs = 10;
    std::uint32_t hotspots = 4;
    std::uint32_t seed = 3;
    double exponent = 3;
    std::string trace;
};

// The host's side of one mission.
class Mission {
public:
    Mission(const Options &options, bool wifi_links);
    jcas_metrics Fly();
    std::uint64_t Beacons() const { return m_beacons; }
    std::uint64_t Received() const { return m_received; }
    double MeanLinks() const { return m_steps == 0 ? 0 : static_cast<double>(m_links) / m_steps; }

private:
    void BuildNetwork(double exponent);
    void BeginStep();
    void EndStep();
    void Beacon(std::uint32_t uav);
    bool Receive(ns3::Ptr<ns3::NetDevice> device, ns3::Ptr<const ns3::Packet> packet,
                 std::uint16_t protocol, const ns3::Address &from);
    std::size_t IndexOf(const ns3::Address &address) const;
    jcas_cell Target(const jcas_uav &uav, float direction) const;
    jcas_cell CellOf(std::uint32_t uav) const;
    void Steer(std::uint32_t uav, jcas_cell target);

    bool m_wifi_links;
    jcas_config m_config;
    jcas::model m_model;
    jcas::sim m_sim;
    jcas::policy m_policy;
    std::vector<float> m_actions;
    ns3::NodeContainer m_nodes;
    ns3::NetDeviceContainer m_devices;
    std::vector<ns3::Address> m_addresses;
    std::vector<std::uint8_t> m_heard; // [receiver][sender], in this step
    std::ofstream m_trace;
    std::uint64_t m_beacons = 0, m_received = 0, m_links = 0, m_steps = 0;
};

jcas_config Configure(const Options &options)
{
    jcas_config config = jcas::preset(options.preset).take();
    config.uav_count = options.uavs;
    config.hotspot_count = options.hotspots;
    config.step_duration_s = STEP_S;
    return config;
}

// Returns the policy in a file, or the baseline of that name if there is no such file.
jcas::policy Load(const jcas::model &model, const std::string &name)
{
    std::ifstream file(name, std::ios::binary);
    if (!file)
        return jcas::policy::baseline(model, name).take();
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
    return jcas::policy::load(model, bytes).take();
}

Mission::Mission(const Options &options, bool wifi_links)
    : m_wifi_links(wifi_links), m_config(Configure(options)),
      m_model(jcas::model::create(m_config).take()), m_sim(jcas::sim::create(m_model).take()),
      m_policy(Load(m_model, options.policy)), m_actions(2 * options.uavs),
      m_heard(options.uavs * options.uavs)
{
    if (m_wifi_links && !options.trace.empty()) {
        m_trace.open(options.trace, std::ios::binary);
        auto write = [this](std::string_view bytes) {
            return !!m_trace.write(bytes.data(), bytes.size());
        };
        m_sim.record(options.seed, write, options.policy, "ns-3").check();
    } else {
        m_sim.reset(options.seed).check();
    }
    BuildNetwork(options.exponent);
}

void Mission::BuildNetwork(double exponent)
{
    m_nodes.Create(m_config.uav_count);
    ns3::MobilityHelper mobility;
    mobility.SetMobilityModel("ns3::ConstantVelocityMobilityModel");
    mobility.Install(m_nodes);
    const std::vector<jcas_uav> uavs = m_sim.uavs();
    for (std::uint32_t i = 0; i < uavs.size(); i++) {
        // UAVs that start in one cell stand apart by a metre, so that no two are in one place.
        double x = (uavs[i].x + 0.5) * m_config.cell_size_m + i % 4;
        double y = (uavs[i].y + 0.5) * m_config.cell_size_m + i / 4;
        m_nodes.Get(i)->GetObject<ns3::MobilityModel>()->SetPosition(ns3::Vector(x, y, 50));
    }

    ns3::YansWifiChannelHelper channel;
    channel.SetPropagationDelay("ns3::ConstantSpeedPropagationDelayModel");
    channel.AddPropagationLoss("ns3::LogDistancePropagationLossModel", "Exponent",
                               ns3::DoubleValue(exponent));
    ns3::YansWifiPhyHelper phy;
    phy.SetChannel(channel.Create());
    ns3::WifiMacHelper mac;
    mac.SetType("ns3::AdhocWifiMac");
    ns3::WifiHelper wifi;
    wifi.SetStandard(ns3::WIFI_STANDARD_80211a);
    wifi.SetRemoteStationManager("ns3::ConstantRateWifiManager", "DataMode",
                                 ns3::StringValue("OfdmRate6Mbps"), "NonUnicastMode",
                                 ns3::StringValue("OfdmRate6Mbps"));
    m_devices = wifi.Install(phy, mac, m_nodes);
    for (std::uint32_t i = 0; i < m_devices.GetN(); i++) {
        m_addresses.push_back(m_devices.Get(i)->GetAddress());
        m_devices.Get(i)->SetReceiveCallback(ns3::MakeCallback(&Mission::Receive, this));
    }
}

jcas_metrics Mission::Fly()
{
    ns3::Simulator::Schedule(ns3::Seconds(0), &Mission::BeginStep, this);
    ns3::Simulator::Run();
    ns3::Simulator::Destroy();
    if (m_trace.is_open())
        m_sim.record_end().check();
    return m_sim.metrics();
}

void Mission::BeginStep()
{
    std::fill(m_heard.begin(), m_heard.end(), std::uint8_t{0});
    m_policy.act(m_sim, m_actions).check();
    const std::vector<jcas_uav> uavs = m_sim.uavs();
    for (std::uint32_t i = 0; i < m_config.uav_count; i++) {
        Steer(i, Target(uavs[i], m_actions[2 * i]));
        ns3::Simulator::Schedule(ns3::Seconds(BEACON_AT_S + BEACON_SPACING_S * i), &Mission::Beacon,
                                 this, i);
    }
    ns3::Simulator::Schedule(ns3::Seconds(STEP_S), &Mission::EndStep, this);
}

void Mission::EndStep()
{
    const std::uint32_t n = m_config.uav_count;
    std::vector<jcas_cell> cells(n);
    std::vector<float> actions = m_actions;
    std::vector<std::uint8_t> links(n * n);
    for (std::uint32_t i = 0; i < n; i++) {
        cells[i] = CellOf(i);
        actions[2 * i] = JCAS_MOVE_STAY; // ns-3 moves
        for (std::uint32_t k = 0; k < n; k++)
            links[n * i + k] = m_heard[n * i + k] && m_heard[n * k + i];
    }
    m_sim.step_begin(actions).check();
    m_sim.set_positions(cells).check();
    m_sim.step_sense().check();
    if (m_wifi_links)
        m_sim.step_communicate_with(links).check();
    else
        m_sim.step_communicate().check();
    const jcas_outcome outcome = m_sim.step_end().take();

    m_sim.links(links).check();
    m_links += static_cast<std::uint64_t>(std::count(links.begin(), links.end(), 1)) / 2;
    m_steps++;
    if (!outcome.terminated && !outcome.truncated)
        BeginStep();
}

void Mission::Beacon(std::uint32_t uav)
{
    m_beacons++;
    m_devices.Get(uav)->Send(ns3::Create<ns3::Packet>(BEACON_BYTES),
                             ns3::Mac48Address::GetBroadcast(), PROTOCOL);
}

bool Mission::Receive(ns3::Ptr<ns3::NetDevice> device, ns3::Ptr<const ns3::Packet>,
                      std::uint16_t protocol, const ns3::Address &from)
{
    if (protocol != PROTOCOL)
        return false;
    m_heard[m_config.uav_count * IndexOf(device->GetAddress()) + IndexOf(from)] = 1;
    m_received++;
    return true;
}

std::size_t Mission::IndexOf(const ns3::Address &address) const
{
    return std::find(m_addresses.begin(), m_addresses.end(), address) - m_addresses.begin();
}

// Returns the cell in a direction, clamped to the grid.
jcas_cell Mission::Target(const jcas_uav &uav, float direction) const
{
    const int motion = std::min(4, static_cast<int>((direction + 1) / 2 * 5));
    const int dx = motion == 2 ? -1 : motion == 3 ? 1 : 0;
    const int dy = motion == 0 ? 1 : motion == 1 ? -1 : 0;
    auto on_grid = [](std::uint32_t at, int by, std::uint32_t extent) {
        return static_cast<std::uint32_t>(
            std::clamp(static_cast<int>(at) + by, 0, static_cast<int>(extent) - 1));
    };
    return {on_grid(uav.x, dx, m_config.grid_width), on_grid(uav.y, dy, m_config.grid_height)};
}

jcas_cell Mission::CellOf(std::uint32_t uav) const
{
    const ns3::Vector at = m_nodes.Get(uav)->GetObject<ns3::MobilityModel>()->GetPosition();
    auto cell = [](double metres, double side, std::uint32_t extent) {
        return static_cast<std::uint32_t>(std::clamp(std::floor(metres / side), 0.0, extent - 1.0));
    };
    return {cell(at.x, m_config.cell_size_m, m_config.grid_width),
            cell(at.y, m_config.cell_size_m, m_config.grid_height)};
}

// Moves a UAV straight to the middle of a cell, at most one cell's side in a step.
void Mission::Steer(std::uint32_t uav, jcas_cell target)
{
    auto model = m_nodes.Get(uav)->GetObject<ns3::ConstantVelocityMobilityModel>();
    const ns3::Vector at = model->GetPosition();
    const double dx = (target.x + 0.5) * m_config.cell_size_m + uav % 4 - at.x;
    const double dy = (target.y + 0.5) * m_config.cell_size_m + uav / 4 - at.y;
    const double distance = std::hypot(dx, dy);
    const double speed = std::min(distance, m_config.cell_size_m) / STEP_S;
    const double scale = distance > 0 ? speed / distance : 0;
    model->SetVelocity(ns3::Vector(dx * scale, dy * scale, 0));
}

void Print(const char *links, const Mission &mission, const jcas_metrics &metrics,
           std::uint32_t hotspots)
{
    std::printf("%-16s %-8s  steps %3u  confirmed %u/%u  known %u/%u  links %4.1f  %.3f kWh  "
                "return %.2f\n",
                links, metrics.terminated ? "complete" : "horizon", metrics.steps,
                metrics.confirmed, hotspots, metrics.informed, hotspots, mission.MeanLinks(),
                metrics.energy_kwh, metrics.return_sum);
}

} // namespace

int main(int argc, char **argv)
{
    Options options;
    ns3::CommandLine command_line(__FILE__);
    command_line.AddValue("preset", "mission, paper or search", options.preset);
    command_line.AddValue("policy", "file of a trained policy, or name of a baseline",
                          options.policy);
    command_line.AddValue("uavs", "UAVs in the fleet", options.uavs);
    command_line.AddValue("hotspots", "hotspots to find", options.hotspots);
    command_line.AddValue("seed", "seed of the mission", options.seed);
    command_line.AddValue("exponent", "path loss exponent of the Wi-Fi channel", options.exponent);
    command_line.AddValue("trace", "file to record the mission over Wi-Fi in", options.trace);
    command_line.Parse(argc, argv);
    jcas::check_abi().check();

    jcas_metrics over_wifi, over_budget;
    {
        Mission mission(options, true);
        over_wifi = mission.Fly();
        std::printf("%llu beacons sent, %llu received\n",
                    static_cast<unsigned long long>(mission.Beacons()),
                    static_cast<unsigned long long>(mission.Received()));
        Print("802.11a in ns-3", mission, over_wifi, options.hotspots);
    }
    {
        Mission mission(options, false);
        over_budget = mission.Fly();
        Print("jcas link budget", mission, over_budget, options.hotspots);
    }
    return over_wifi.confirmed > 0 && over_budget.confirmed > 0 ? 0 : 1;
}
