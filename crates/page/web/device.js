// The page's device: another one is opened where it was lost.
import { Page } from "./rasterlab_page.js";
import { goesOn } from "./trouble.js";

let page;

/** The device as it is now. */
export async function device() {
  if (!page || page.is_lost()) page = await Page.open();
  return page;
}

/** Does `act`, and does it again on another device where that was lost meanwhile. `lost` is told so before. */
export async function again(act, lost = () => {}) {
  for (;;) {
    try {
      return await act();
    } catch (error) {
      if (!goesOn(error)) throw error;
      page = undefined;
      lost();
    }
  }
}
