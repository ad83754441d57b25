// ‮text
fn ink() {}