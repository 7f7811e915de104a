// SPDX-License-Identifier: GPL-3.0-or-later
// A robot of links and joints that tests write themselves.
#pragma once

#include <string>

namespace trellis::test {

/// Six joints, of which the second slides; links of balls, 0.3 m apart; fingers that follow joint 6.
inline const char* const six_joints = R"(<robot name="six">
<link name="base"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="l1"><collision><origin xyz="0 0 0.15"/><geometry><sphere radius="0.07"/></geometry></collision></link>
<link name="l2"><collision><origin xyz="0.15 0 0"/><geometry><sphere radius="0.06"/></geometry></collision>
  <collision><origin xyz="0.25 0 0"/><geometry><sphere radius="0.05"/></geometry></collision></link>
<link name="l3"><collision><origin xyz="0.15 0 0"/><geometry><sphere radius="0.05"/></geometry></collision></link>
<link name="l4"><collision><origin xyz="0 0 0.15"/><geometry><sphere radius="0.05"/></geometry></collision></link>
<link name="l5"><collision><origin xyz="0.1 0 0"/><geometry><sphere radius="0.04"/></geometry></collision></link>
<link name="hand"><collision><origin xyz="0.05 0 0"/><geometry><sphere radius="0.04"/></geometry></collision></link>
<link name="tool"/>
<joint name="turn" type="continuous"><parent link="base"/><child link="l1"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/></joint>
<joint name="lift" type="prismatic"><parent link="l1"/><child link="l2"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>
  <limit lower="0" upper="0.4"/></joint>
<joint name="elbow" type="revolute"><parent link="l2"/><child link="l3"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2"/></joint>
<joint name="roll" type="revolute"><parent link="l3"/><child link="l4"/><origin xyz="0.3 0 0"/><axis xyz="1 0 0"/>
  <limit lower="-3" upper="3"/></joint>
<joint name="wrist" type="revolute"><parent link="l4"/><child link="l5"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2"/></joint>
<joint name="flange" type="revolute"><parent link="l5"/><child link="hand"/><origin xyz="0.2 0 0"/><axis xyz="1 0 0"/>
  <limit lower="-3" upper="3"/></joint>
<joint name="mount" type="fixed"><parent link="hand"/><child link="tool"/><origin xyz="0.1 0 0"/></joint>
</robot>
)";

inline const char* const six_joints_srdf = R"(<robot name="six">
<group name="arm"><chain base_link="base" tip_link="hand"/></group>
<group name="wrist"><joint name="wrist"/><joint name="flange"/></group>
<group_state name="ready" group="arm"><joint name="turn" value="0"/><joint name="lift" value="0.1"/>
  <joint name="elbow" value="0.5"/><joint name="roll" value="0"/><joint name="wrist" value="0.3"/>
  <joint name="flange" value="0"/></group_state>
<group_state name="aside" group="arm"><joint name="turn" value="2"/><joint name="lift" value="0.2"/>
  <joint name="elbow" value="0.4"/><joint name="roll" value="0.2"/><joint name="wrist" value="0.3"/>
  <joint name="flange" value="0"/></group_state>
<disable_collisions link1="l2" link2="l4" reason="never"/>
</robot>
)";

}  // namespace trellis::test
