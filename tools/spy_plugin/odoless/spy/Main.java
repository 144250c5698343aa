package odoless.spy;

import java.io.IOException;
import javax.swing.JFrame;
import javax.swing.SwingUtilities;
import lcm.lcm.LCM;

/** lcm-spy, and beside it the map of the robot whose channels begin with the first argument, if there is one. */
public final class Main {
  private Main() {}

  public static void main(String[] arguments) throws IOException {
    lcm.spy.Spy.main(new String[0]);
    if (arguments.length == 1) {
      SwingUtilities.invokeLater(() -> showMap(arguments[0]));
    }
  }

  private static void showMap(String prefix) {
    final JFrame frame = new JFrame(MapPlugin.TITLE);
    frame.add(new MapPanel(new MapModel(LCM.getSingleton(), prefix)));
    frame.pack();
    frame.setLocation(820, 0);
    frame.setVisible(true);
  }
}
