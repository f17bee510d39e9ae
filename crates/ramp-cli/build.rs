//! Links libmujoco, and notes the commit that the program is built from.

#[path = "../../tools/commit.rs"]
mod commit;
#[path = "../../tools/link_mujoco.rs"]
mod link_mujoco;

fn main() {
    link_mujoco::main();
    commit::main();
}
