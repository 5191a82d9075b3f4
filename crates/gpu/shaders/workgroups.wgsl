// Computes the workgroups of indirect dispatches.

// Writes the workgroups for `count` invocations. Invocations beyond `count` must return at once.
fn set_workgroups(argument: u32, count: u32) {
    let groups = (count + WORKGROUP - 1u) / WORKGROUP;
    let columns = min(groups, GROUP_COLUMNS);
    arguments[3u * argument] = columns;
    arguments[3u * argument + 1u] = select((groups + GROUP_COLUMNS - 1u) / GROUP_COLUMNS, 0u, groups == 0u);
    arguments[3u * argument + 2u] = 1u;
}
